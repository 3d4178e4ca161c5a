// Link of a robot to a registry: sessions, versions, and a server that is away, refuses, hangs or is damaged.

#include "registry_fixture.h"

#include "byre/registry/robot_link.h"

#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class RobotRegistry : public RegistryTest {
 protected:
  void SetUp() override {
    RegistryTest::SetUp();
    if (IsSkipped()) return;
    base_ = write_small_map("barn.byre", "of the robot");
    ASSERT_EQ(registry("push barn barn.byre", "reviewer").exit_code, 0);
    ASSERT_EQ(registry("accept barn " + base_, "reviewer").exit_code, 0);
  }

  RobotLinkOptions options(const std::string& account = "robot_barn") const {
    return {uri(account), "barn", folder_ / "barn.byre", folder_ / "barn.registry", 0.2};
  }

  // Pushes and accepts a map, and returns its id.
  std::string accept_new(const std::string& note, std::size_t bytes = 100) const {
    const std::string id = write_small_map("new.byre", note, bytes);
    EXPECT_EQ(registry("push barn new.byre", "reviewer").exit_code, 0);
    EXPECT_EQ(registry("accept barn " + id, "reviewer").exit_code, 0);
    return id;
  }

  // Queues a session as a mission would.
  bool queue(RobotLink& link, const std::string& name) const {
    fs::create_directories(link.last_session().parent_path());
    write_small_session("barn.registry/last.session", name, base_);
    return link.queue_last_session(name);
  }

  static testing::AssertionResult becomes(const RobotLink& link,
                                          const std::function<bool(const RobotLinkState&)>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      if (holds(link.state())) return testing::AssertionSuccess();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return testing::AssertionFailure() << "fault: " << link.state().fault << ", refused: " << link.state().reason;
  }
  static bool has_sent_all(const RobotLinkState& state) { return state.contact && state.waiting == 0; }

  std::string names_of_sessions() const {
    return value("SELECT coalesce(string_agg(name, ' ' ORDER BY name), '') FROM byre.session");
  }

  std::string base_;
};

TEST_F(RobotRegistry, SendsSessionsOnceTheServerIsThere) {
  RegistryServer::shared().kill();
  {
    RobotLink link(options());
    link.start();
    EXPECT_TRUE(queue(link, "monday"));
    EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return !state.fault.empty(); }));
    EXPECT_EQ(link.state().waiting, 1);
    EXPECT_FALSE(link.state().contact);
    EXPECT_EQ(link.state().present, base_);
  }
  RobotLink link(options());  // the next day
  EXPECT_TRUE(queue(link, "tuesday"));
  EXPECT_TRUE(queue(link, "tuesday")) << "a clock that was set back";
  EXPECT_EQ(link.state().waiting, 3);
  RegistryServer::shared().start();
  link.start();
  EXPECT_TRUE(becomes(link, has_sent_all));
  EXPECT_EQ(names_of_sessions(), "monday tuesday") << "equal sessions are one";
  EXPECT_EQ(value("SELECT count(*) FROM byre.job"), "1");
  EXPECT_EQ(value("SELECT added_by FROM byre.session LIMIT 1"), "robot_barn");
  EXPECT_TRUE(fs::exists(link.last_session())) << "it proves versions";
}

TEST_F(RobotRegistry, LosesNothingIfTheServerIsKilled) {
  RobotLink link(options());
  {
    Connection owner = connect();
    Transaction lock(owner);
    owner.run("LOCK TABLE byre.session IN ACCESS EXCLUSIVE MODE");
    for (const char* const name : {"monday", "tuesday", "wednesday"}) EXPECT_TRUE(queue(link, name));
    link.start();
    const auto is_pushing = [this] {
      return value("SELECT count(*) FROM pg_stat_activity WHERE usename = 'robot_barn' AND wait_event_type = 'Lock'") !=
             "0";
    };
    for (int i = 0; i < 3000 && !is_pushing(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    RegistryServer::shared().kill();
  }
  RegistryServer::shared().start();
  EXPECT_TRUE(becomes(link, has_sent_all));
  EXPECT_EQ(names_of_sessions(), "monday tuesday wednesday");
}

TEST_F(RobotRegistry, FetchesTheAcceptedVersionForTheDock) {
  RobotLink link(options());
  link.start();
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState& state) { return state.accepted == base_; }));
  EXPECT_FALSE(link.fetched());
  const std::string first = accept_new("first", 2'500'000), second = accept_new("second");
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState& state) { return state.fetched == second; }));
  ASSERT_EQ(link.fetched(), folder_ / "barn.registry" / (second + ".byre"));
  EXPECT_EQ(read("barn.registry/" + second + ".byre"), read("new.byre"));
  EXPECT_EQ(to_text(map_id(folder_ / "barn.byre")), base_) << "the map in use stays";
  link.refuse(*link.fetched(), "places would be worse");
  const auto contact = link.state().contact;
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState& state) { return state.contact > contact; }));
  EXPECT_EQ(link.state().reason, "places would be worse");
  const auto reported = [&] {
    return value("SELECT runs || ' ' || refused || ' ' || reason FROM byre.robot WHERE account = 'robot_barn'");
  };
  const std::string expected = base_ + " " + second + " places would be worse";
  for (int i = 0; i < 3000 && reported() != expected; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(reported(), expected);
  fs::copy_file(*link.fetched(), folder_ / "barn.byre", fs::copy_options::overwrite_existing);
  link.note_present();
  EXPECT_EQ(link.state().present, second);
  EXPECT_EQ(link.state().refused + link.state().fetched, "");
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState&) {
    return !fs::exists(folder_ / "barn.registry" / (second + ".byre"));
  })) << "it is in use";
  EXPECT_FALSE(fs::exists(folder_ / "barn.registry" / (first + ".byre")));
}

TEST_F(RobotRegistry, RefusesAVersionWithoutItsHash) {
  RobotLink link(options());
  const std::string id = accept_new("damaged");
  connect().run_script(
      "ALTER TABLE byre.chunk DISABLE TRIGGER ALL; ALTER TABLE byre.chunk DROP CONSTRAINT chunk_hash;"
      "UPDATE byre.chunk SET data = set_byte(data, length(data) - 1, get_byte(data, length(data) - 1) # 1)");
  EXPECT_TRUE(queue(link, "monday"));
  link.start();
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState& state) { return state.refused == id && state.waiting == 0; }));
  EXPECT_THAT(link.state().reason, HasSubstr("does not have its SHA-256"));
  EXPECT_FALSE(link.fetched());
  EXPECT_FALSE(fs::exists(folder_ / "barn.registry" / (id + ".byre")));
  EXPECT_EQ(names_of_sessions(), "monday") << "sessions are sent all the same";
  connect().run("UPDATE byre.chunk SET data = set_byte(data, length(data) - 1, get_byte(data, length(data) - 1) # 1)");
  EXPECT_TRUE(becomes(link, [&](const RobotLinkState& state) { return state.fetched == id; }));
  EXPECT_EQ(link.state().refused, "");
}

TEST_F(RobotRegistry, StoresNoSessionBeyondTheBound) {
  RobotLinkOptions small = options("robot_annex");  // may not see the barn
  ASSERT_TRUE(fs::create_directories(small.folder));
  write_small_session("barn.registry/last.session", "monday", base_);
  small.max_bytes = 5 * fs::file_size(small.folder / "last.session") / 2;
  RobotLink link(small);
  link.start();
  EXPECT_TRUE(queue(link, "monday"));
  EXPECT_TRUE(queue(link, "sunday"));
  EXPECT_FALSE(queue(link, "friday"));
  EXPECT_EQ(link.state().left_out, 1);
  EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return !state.fault.empty(); }));
  EXPECT_THAT(link.state().fault, HasSubstr("has no site 'barn', or the account may not see it"));
  EXPECT_EQ(link.state().waiting, 2);
  EXPECT_TRUE(fs::exists(small.folder / "monday.session"));
}

TEST_F(RobotRegistry, KeepsASessionThatTheServerRefusesAndSendsOthers) {
  RobotLink link(options());
  EXPECT_TRUE(queue(link, "tuesday"));
  write("barn.registry/monday.session", "no session");
  link.start();
  EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return state.contact && state.waiting == 1; }));
  EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return !state.fault.empty(); }));
  EXPECT_THAT(link.state().fault, HasSubstr("monday.session"));
  EXPECT_EQ(names_of_sessions(), "tuesday");
}

TEST_F(RobotRegistry, GoesOnWithAnAccountThatIsNotAdmitted) {
  RobotLink link(options("stranger"));
  link.start();
  EXPECT_TRUE(queue(link, "monday"));
  EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return !state.fault.empty(); }));
  EXPECT_THAT(link.state().fault, AllOf(HasSubstr("stranger"), HasSubstr("admits the account")));
  EXPECT_EQ(link.state().waiting, 1);
}

TEST_F(RobotRegistry, GoesOnWithAWrongPassword) {
  const fs::path file = RegistryServer::shared().folder() / "data" / "pg_hba.conf";
  std::ostringstream before;
  before << std::ifstream(file).rdbuf();
  const auto admit_by = [&](const std::string& lines) {
    std::ofstream(file) << lines << before.str();
    connect().run("SELECT pg_reload_conf()");
  };
  connect().run("ALTER ROLE robot_barn PASSWORD 'right'");
  admit_by("local all robot_barn scram-sha-256\n");
  RobotLinkOptions wrong = options(), right = options();
  wrong.database += " password=wrong";
  right.database += " password=right";
  {
    RobotLink link(wrong);
    link.start();
    EXPECT_TRUE(becomes(link, [](const RobotLinkState& state) { return !state.fault.empty(); }));
    EXPECT_THAT(link.state().fault, HasSubstr("password authentication failed for user \"robot_barn\""));
    EXPECT_TRUE(queue(link, "monday"));
    EXPECT_EQ(link.state().waiting, 1);
  }
  RobotLink link(right);
  link.start();
  EXPECT_TRUE(becomes(link, has_sent_all));
  admit_by("");
  connect().run("ALTER ROLE robot_barn PASSWORD NULL");
}

TEST_F(RobotRegistry, EndsWhileTheServerHangs) {
  Connection owner = connect();
  Transaction lock(owner);
  owner.run("LOCK TABLE byre.version IN ACCESS EXCLUSIVE MODE");
  std::optional<RobotLink> link(std::in_place, options());
  link->start();
  EXPECT_TRUE(becomes(*link, [](const RobotLinkState& state) { return state.contact.has_value(); }));
  link.reset();
  lock.commit();
}

}  // namespace
}  // namespace byre
