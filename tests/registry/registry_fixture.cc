#include "registry_fixture.h"

#include "byre/input_error.h"
#include "byre/registry/connection.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

StoredMap noted(const std::string& note, std::size_t bytes) {
  std::mt19937_64 random(std::hash<std::string>()(note));
  std::string filling(bytes, ' ');
  for (char& character : filling) character = static_cast<char>('a' + random() % 26);
  StoredMap stored;
  stored.notes["note"] = note + " " + filling;
  return stored;
}

int run_script(const fs::path& folder, const std::string& action) {
  const std::string log = folder.string() + ".log";
  const int status =
      std::system(fmt::format("'{}' '{}' {} >'{}' 2>&1", BYRE_REGISTRY_SCRIPT, folder.string(), action, log).c_str());
  fs::remove(log);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Servers of test programs that crashed.
void remove_abandoned(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    int process = 0;
    const std::string name = entry.path().filename().string();
    if (std::sscanf(name.c_str(), "byre_registry.%d", &process) != 1 || !entry.is_directory()) continue;
    if (::kill(process, 0) == 0 || errno != ESRCH) continue;
    run_script(entry.path(), "kill");
    std::error_code error;
    fs::remove_all(entry.path(), error);
  }
}

}  // namespace

RegistryServer& RegistryServer::shared() {
  static RegistryServer server;
  return server;
}

RegistryServer::RegistryServer()
    : folder_(fs::path(testing::TempDir()) / fmt::format("byre_registry.{}", getpid())),
      owner_(geteuid() == 0                   ? "postgres"
             : std::getenv("USER") != nullptr ? std::getenv("USER")
                                              : "") {
  remove_abandoned(folder_.parent_path());
  const int code = run_script(folder_, "start");
  is_installed_ = code == 0;
  if (code != 0 && code != 77) throw std::runtime_error("scripts/registry.sh fails");
  if (!is_installed_) return;
  // Its files outlive a killed server without it. Only a failure of the machine needs it.
  Connection server(uri("byre"));
  server.run("ALTER SYSTEM SET fsync = off");
  server.run("SELECT pg_reload_conf()");
}

RegistryServer::~RegistryServer() {
  if (is_installed_) kill();
  std::error_code error;
  fs::remove_all(folder_, error);
}

std::string RegistryServer::uri(const std::string& database, const std::string& account) const {
  return fmt::format("host={} dbname={} user={}", (folder_ / "socket").string(), database,
                     account.empty() ? owner_ : account);
}

void RegistryServer::kill() const {
  if (run_script(folder_, "kill") != 0) throw std::runtime_error("the server was not killed");
}

void RegistryServer::start() const {
  if (run_script(folder_, "start") != 0) throw std::runtime_error("the server does not start");
}

std::vector<std::byte> small_map(const std::string& note, std::size_t bytes) {
  return write_map(noted(note, bytes));
}

std::vector<std::byte> small_session(const std::string& note, const std::string& ran_on, std::size_t bytes) {
  SessionRecord session;
  std::from_chars(ran_on.data(), ran_on.data() + ran_on.size(), session.map_id, 16);
  return write_map(noted(note, bytes), MapUpkeep{{}, session});
}

void RegistryTest::SetUp() {
  if (!RegistryServer::shared().is_installed()) GTEST_SKIP() << "no PostgreSQL is installed (apt install postgresql)";
  static int tests = 0;
  database_ = fmt::format("test_{}", ++tests);
  Connection server(RegistryServer::shared().uri("byre"));
  server.run_script("CREATE DATABASE " + database_ + " STRATEGY file_copy");
  Connection owner = connect();
  migrate_registry(owner);
  owner.run_script(
      "INSERT INTO byre.site (name) VALUES ('barn'), ('annex');"
      "SELECT byre.admit('robot_' || name, 'robot', id) FROM byre.site;"
      "SELECT byre.admit('reviewer', 'reviewer', NULL); SELECT byre.admit('worker', 'worker', NULL)");
  if (owner.run("SELECT FROM pg_roles WHERE rolname = 'outsider'").size() == 0) owner.run("CREATE ROLE outsider LOGIN");
}

void RegistryTest::TearDown() {
  if (database_.empty()) return;
  Connection server(RegistryServer::shared().uri("byre"));
  server.run_script("DROP DATABASE " + database_ + " WITH (FORCE)");
}

std::string RegistryTest::uri(const std::string& account) const {
  return RegistryServer::shared().uri(database_, account);
}

std::string RegistryTest::value(const char* query, const std::vector<Parameter>& parameters) const {
  return connect().run(query, parameters).text(0, 0);
}

cli::Outcome RegistryTest::registry(const std::string& arguments, const std::string& account) const {
  return run("registry " + arguments + " --registry '" + uri(account) + "'");
}

cli::Outcome RegistryTest::worker(const std::string& arguments) const {
  return run("worker " + arguments + " --registry '" + uri("worker") + "'");
}

std::string RegistryTest::write_small_map(const std::string& file, const std::string& note, std::size_t bytes) const {
  save_map(noted(note, bytes), folder_ / file);
  return to_text(map_id(folder_ / file));
}

std::string RegistryTest::write_small_session(const std::string& file, const std::string& note,
                                              const std::string& ran_on) const {
  SessionRecord session;
  std::from_chars(ran_on.data(), ran_on.data() + ran_on.size(), session.map_id, 16);
  save_map(noted(note, 100), MapUpkeep{{}, session}, folder_ / file);
  return to_text(map_id(folder_ / file));
}

std::string RegistryTest::refusal(const std::string& account, const char* statement,
                                  const std::vector<Parameter>& parameters) const {
  Connection connection = connect(account);
  try {
    connection.run(statement, parameters);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace byre
