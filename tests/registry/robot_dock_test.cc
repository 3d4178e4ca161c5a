// Missions of a robot that sends its sessions to a registry and takes its map from there, without DDS.

#include "registry_fixture.h"

#include "byre/recording.h"
#include "byre/ros2/node/slam_runner.h"

#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using cli::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// A robot with the accepted map, of half of the recording.
class RobotAtTheDock : public RegistryTest {
 protected:
  void SetUp() override {
    RegistryTest::SetUp();
    if (IsSkipped()) return;
    map_room("--frames :12", "room.byre");
    base_ = id_of("room.byre");
    accept("room.byre");
  }

  NodeConfig config() const {
    NodeConfig config;
    config.map = folder_ / "room.byre";
    config.update = MapUpdates::automatic;
    config.workers = Workers::none;
    config.registry = {uri("robot_barn"), "barn", 0.2};
    return config;
  }

  std::string id_of(const std::string& file) const { return to_text(map_id(folder_ / file)); }

  void accept(const std::string& file) const {
    const Outcome pushed = registry("push barn " + file, "reviewer");
    ASSERT_EQ(pushed.exit_code, 0) << pushed.errors;
    const Outcome accepted = registry("accept barn " + id_of(file), "reviewer");
    ASSERT_EQ(accepted.exit_code, 0) << accepted.errors;
  }

  // first: frame, so that sessions differ.
  static void drive(SlamRunner& runner, int first = 0) {
    const auto recording = open_recording(RenderedFixture::shared().folder(), {});
    if (!runner.is_running()) {
      EXPECT_EQ(runner.start(recording->calibration()), "");
    }
    int localised = 0;
    for (int i = first; i < recording->size(); ++i) {
      localised += runner.process(view_of(recording->read(i).value())).map_from_body.has_value();
    }
    EXPECT_GT(localised, recording->size() / 2);
  }

  template <typename Holds>
  static testing::AssertionResult becomes(const SlamRunner& runner, const Holds& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      if (holds(*runner.registry())) return testing::AssertionSuccess();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return testing::AssertionFailure() << "fault: " << runner.registry()->fault;
  }

  std::string base_;
};

TEST_F(RobotAtTheDock, TakesTheVersionMadeOfItsSession) {
  RegistryServer::shared().kill();
  SlamRunner runner(config());
  drive(runner);
  const CommandResult first = execute(runner, "update");
  EXPECT_THAT(first.answer, AllOf(HasSubstr("room.byre stays as it is: no other version is accepted"),
                                  HasSubstr("waits for the registry")));
  EXPECT_TRUE(first.restarts && !first.loads);
  EXPECT_THAT(execute(runner, "update").answer, HasSubstr("no session to send"));
  EXPECT_EQ(runner.registry()->waiting, 1);
  drive(runner, 1);

  RegistryServer::shared().start();
  EXPECT_TRUE(becomes(runner, [](const RobotLinkState& state) { return state.contact && state.waiting == 0; }));
  const Outcome work = worker();
  EXPECT_EQ(work.exit_code, 0) << work.errors;
  const std::string made = value("SELECT id FROM byre.version WHERE state = 'proposed'");
  EXPECT_EQ(registry("accept barn " + made, "reviewer").exit_code, 0);
  EXPECT_TRUE(becomes(runner, [&](const RobotLinkState& state) { return state.fetched == made; }));
  EXPECT_EQ(id_of("room.byre"), base_) << "away from the dock";

  const CommandResult second = execute(runner, "update");
  EXPECT_THAT(second.answer, AllOf(StartsWith("updated "), HasSubstr(" to version " + made)));
  EXPECT_TRUE(second.restarts && second.loads);
  EXPECT_EQ(id_of("room.byre"), made);
  EXPECT_EQ(id_of("room.previous.byre"), base_);
  EXPECT_EQ(runner.registry()->present, made);
  EXPECT_TRUE(becomes(runner, [](const RobotLinkState& state) { return state.waiting == 0; }));
  EXPECT_EQ(value("SELECT count(*) FROM byre.session WHERE ran_on = $1", {base_}), "2");
  drive(runner);

  EXPECT_EQ(registry("rollback barn --reason 'robots get lost'", "reviewer").exit_code, 0);
  EXPECT_TRUE(becomes(runner, [&](const RobotLinkState& state) { return state.fetched == base_; }));
  EXPECT_THAT(execute(runner, "update").answer, HasSubstr(" to version " + base_));
  EXPECT_EQ(id_of("room.byre"), base_) << "a version that the map was made of";
}

TEST_F(RobotAtTheDock, RefusesVersionsThatItsLastSessionDoesNotProve) {
  SlamRunner runner(config());
  map_room("--frames 12:", "other.byre");  // in a frame of its own
  accept("other.byre");
  const std::string other = id_of("other.byre");
  const auto recording = open_recording(RenderedFixture::shared().folder(), {});
  EXPECT_EQ(runner.start(recording->calibration()), "");
  EXPECT_TRUE(becomes(runner, [&](const RobotLinkState& state) { return state.fetched == other; }));
  EXPECT_THAT(execute(runner, "update").answer, HasSubstr("is refused: no session proves it yet"));
  drive(runner);
  EXPECT_THAT(execute(runner, "update").answer,
              AllOf(HasSubstr("version " + other + " is refused: "), HasSubstr("places would be worse than before")));
  EXPECT_EQ(runner.registry()->refused, other);

  write_small_map("empty.byre", "without keyframes");
  accept("empty.byre");
  const std::string empty = id_of("empty.byre");
  EXPECT_TRUE(becomes(runner, [&](const RobotLinkState& state) { return state.fetched == empty; }));
  drive(runner);
  EXPECT_THAT(execute(runner, "update").answer, HasSubstr("version " + empty + " is refused: "));
  EXPECT_EQ(id_of("room.byre"), base_);
  EXPECT_FALSE(fs::exists(previous_map(folder_ / "room.byre")));
}

TEST_F(RobotAtTheDock, ProposesAVersionIfItIsSetSo) {
  NodeConfig proposing = config();
  proposing.update = MapUpdates::propose;
  SlamRunner runner(proposing);
  drive(runner);
  execute(runner, "update");
  EXPECT_TRUE(becomes(runner, [](const RobotLinkState& state) { return state.contact && state.waiting == 0; }));
  EXPECT_EQ(worker().exit_code, 0);
  const std::string made = value("SELECT id FROM byre.version WHERE state = 'proposed'");
  EXPECT_EQ(registry("accept barn " + made, "reviewer").exit_code, 0);
  EXPECT_TRUE(becomes(runner, [&](const RobotLinkState& state) { return state.fetched == made; }));
  EXPECT_THAT(execute(runner, "update").answer, StartsWith("proposed "));
  EXPECT_EQ(id_of("room.byre"), base_);
  EXPECT_EQ(id_of("room.proposed.byre"), made);
}

}  // namespace
}  // namespace byre
