#pragma once

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_upkeep.h"
#include "byre/registry/connection.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// PostgreSQL server of scripts/registry.sh in a temporary folder, one for all tests of the program.
class RegistryServer {
 public:
  static RegistryServer& shared();

  ~RegistryServer();
  RegistryServer(const RegistryServer&) = delete;
  RegistryServer& operator=(const RegistryServer&) = delete;

  bool is_installed() const { return is_installed_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& owner() const { return owner_; }
  // For any account, or the owner.
  std::string uri(const std::string& database, const std::string& account = "") const;
  void kill() const;  // SIGKILL
  void start() const;

 private:
  RegistryServer();

  std::filesystem::path folder_;
  std::string owner_;
  bool is_installed_ = false;
};

// Each test has a registry of its own, with the sites "barn" and "annex" and the accounts robot_barn, robot_annex,
// reviewer, worker and outsider.
class RegistryTest : public cli::ProgramTest {
 protected:
  void SetUp() override;
  void TearDown() override;

  std::string uri(const std::string& account = "") const;
  Connection connect(const std::string& account = "") const { return Connection(uri(account)); }
  // Value of a query as the owner.
  std::string value(const char* query, const std::vector<Parameter>& parameters = {}) const;

  // "byre registry ARGUMENTS" of an account.
  cli::Outcome registry(const std::string& arguments, const std::string& account = "") const;
  cli::Outcome worker(const std::string& arguments = "--once") const;

  // A map without keyframes, made different by a note. bytes: about its size.
  std::string write_small_map(const std::string& file, const std::string& note, std::size_t bytes = 100) const;
  // A session without keyframes, on a map with this id.
  std::string write_small_session(const std::string& file, const std::string& note, const std::string& ran_on) const;

  // Message with which the server refuses a statement; empty: it did not.
  std::string refusal(const std::string& account, const char* statement,
                      const std::vector<Parameter>& parameters = {}) const;

  std::string database_;
};

// Bytes of such a map, and of such a session.
std::vector<std::byte> small_map(const std::string& note, std::size_t bytes = 100);
std::vector<std::byte> small_session(const std::string& note, const std::string& ran_on, std::size_t bytes = 100);

}  // namespace byre
