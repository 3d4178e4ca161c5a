// "byre registry serve": HTTP interface of the page, with the rights of PostgreSQL.

#include "cutting_proxy.h"
#include "registry_fixture.h"

#include "byre/registry/blobs.h"
#include "byre/registry/versions.h"
#include "byre/viewer/web/web_client_scene.h"

#include <optional>

#include <gmock/gmock.h>

#include <fmt/format.h>

namespace byre {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr std::int64_t kBarn = 1;

class RegistryReviewPage : public RegistryTest {
 protected:
  void TearDown() override {
    end_page();
    RegistryTest::TearDown();
  }

  void end_page() {
    if (!process_) return;
    kill(*process_, SIGINT);
    EXPECT_EQ(exit_code_of(*process_), 0);
    process_.reset();
  }

  // Starts the page as an account, and sets its token.
  WebClient serve(const std::string& account, const std::string& address = "127.0.0.1",
                  const std::vector<std::string>& options = {}) {
    return serve_from(uri(account), address, options);
  }

  WebClient serve_from(const std::string& registry_uri, const std::string& address = "127.0.0.1",
                       const std::vector<std::string>& options = {}) {
    std::vector<std::string> command = {"registry", "serve", "--port",     "0",
                                        "--bind",   address, "--registry", registry_uri};
    command.insert(command.end(), options.begin(), options.end());
    process_ = start(command);
    const std::string label = "viewer: http://127.0.0.1:";
    EXPECT_TRUE(appears(label, "stderr.txt")) << read("stderr.txt");
    const std::string rest = read("stderr.txt").substr(read("stderr.txt").find(label) + label.size());
    const std::string target = rest.substr(rest.find('/'));
    if (target.starts_with("/?")) token_ = target.substr(1, target.find('\n') - 1);
    port_ = std::stoi(rest);
    return WebClient(port_);
  }

  // Proposes a small map as the reviewer. Returns its id.
  std::string propose(const std::string& note, const std::vector<std::string>& parents = {},
                      std::int64_t site = kBarn) const {
    Connection reviewer = connect("reviewer");
    const std::vector<std::byte> map = small_map(note);
    const std::string id = to_text(map_id(map, ""));
    add_version(reviewer, site, id, push_blob(reviewer, map), parents, note);
    return id;
  }

  std::string state_of(const std::string& id) const {
    return value("SELECT state FROM byre.version WHERE site = 1 AND id = $1", {id});
  }

  static std::string problem_of(const WebClient::Answer& answer) {
    EXPECT_GE(answer.status, 400) << answer.body;
    return answer.json().at("problem");
  }

  // Scene of the map of a version, once it is pulled.
  static json scene_of(const WebClient& page, const std::string& version) {
    const std::string target = "/maps/barn/" + version + "/scene";
    WebClient::Answer answer = page.get(target);
    while (answer.status == 202) answer = page.get(target);
    return answer.json();
  }

  static std::string reason(const std::string& text) { return json{{"reason", text}}.dump(); }

  std::optional<pid_t> process_;
  std::string token_;  // "?token=..."
  int port_ = 0;
};

TEST_F(RegistryReviewPage, ShowsWhatTheCommandsPrint) {
  const std::string id = propose("by day");
  const WebClient page = serve("reviewer");
  EXPECT_THAT(page.get("/").content_type, StartsWith("text/html"));
  const json scene = page.get("/scene").json();
  EXPECT_EQ(scene.at("mode"), "registry");
  EXPECT_EQ(scene.at("account"), "reviewer");
  EXPECT_EQ(page.get("/sites").json(), json::parse(registry("list --json", "reviewer").output));
  EXPECT_EQ(page.get("/sites/barn").json(), json::parse(registry("list barn --json", "reviewer").output));
  EXPECT_EQ(page.get("/sites/barn/events").json(), json::parse(registry("history barn --json", "reviewer").output));
  json version = page.get("/sites/barn/" + id).json();
  EXPECT_EQ(version.at("reviews").at("accept"), (json{{"version", id}, {"refusal", ""}}));
  EXPECT_THAT(version.at("reviews").at("rollback").at("refusal").get<std::string>(),
              StartsWith("there is no earlier accepted version"));
  version.erase("reviews");
  EXPECT_EQ(version, json::parse(registry("show barn " + id + " --json", "reviewer").output));
  EXPECT_EQ(state_of(id), "proposed") << "showing a version changes nothing";
  EXPECT_EQ(value("SELECT count(*) FROM byre.event"), "1");
}

TEST_F(RegistryReviewPage, AcceptsRejectsAndRollsBackWithReasons) {
  const std::string first = propose("first"), second = propose("second"), third = propose("third");
  const WebClient page = serve("reviewer");
  EXPECT_EQ(page.post("/sites/barn/" + first + "/accept", reason("looks right")).json().at("version"), first);
  EXPECT_EQ(page.post("/sites/barn/" + second + "/accept", reason("newer")).status, 200);
  EXPECT_EQ(page.post("/sites/barn/" + third + "/reject", reason("no gate")).json().at("version"), third);
  EXPECT_EQ(state_of(first) + " " + state_of(second) + " " + state_of(third), "retired accepted retired");
  const json reviews = page.get("/sites/barn/" + second).json().at("reviews");
  EXPECT_EQ(reviews.at("rollback").at("version"), first) << "the page of the accepted version names the one before";
  EXPECT_THAT(reviews.at("accept").at("refusal").get<std::string>(), HasSubstr("is not proposed"));
  EXPECT_THAT(problem_of(page.post("/sites/barn/" + third + "/accept", reason("after all"))),
              AllOf(StartsWith("registry "), HasSubstr("version " + third + " is not proposed (byre registry list")));
  EXPECT_THAT(problem_of(page.post("/sites/barn/" + third + "/rollback", reason("after all"))),
              HasSubstr("there is no earlier accepted version " + third));
  EXPECT_EQ(page.post("/sites/barn/" + first + "/rollback", reason("robots get lost")).status, 200);
  EXPECT_EQ(state_of(first) + " " + state_of(second), "accepted retired");
  const std::string history = registry("history barn", "reviewer").output;
  EXPECT_THAT(history, HasSubstr("accepted " + first + " by reviewer: robots get lost"));
  EXPECT_THAT(history, HasSubstr("retired " + third + " by reviewer: no gate"));
}

TEST_F(RegistryReviewPage, RefusesAVersionMadeOfAnotherThanTheAcceptedOne) {
  const std::string first = propose("first"), second = propose("second"), child = propose("child", {first});
  const WebClient page = serve("reviewer");
  page.post("/sites/barn/" + second + "/accept", reason("newer"));
  const std::string expected = "version " + child + " was not made of " + second + ", which is accepted";
  EXPECT_THAT(page.get("/sites/barn/" + child).json().at("reviews").at("accept").at("refusal").get<std::string>(),
              StartsWith(expected));
  EXPECT_THAT(problem_of(page.post("/sites/barn/" + child + "/accept", reason("x"))), HasSubstr(expected));
  EXPECT_EQ(state_of(child), "proposed");
}

TEST_F(RegistryReviewPage, HasTheRightsOfItsAccount) {
  const std::string accepted = propose("accepted"), proposed = propose("proposed"), other = propose("other", {}, 2);
  connect("reviewer").run("SELECT byre.accept(1, $1, '')", {accepted});
  const WebClient page = serve("robot_barn");
  EXPECT_EQ(page.get("/sites").json().size(), 1u) << "of its own site";
  EXPECT_THAT(problem_of(page.get("/sites/annex")), HasSubstr("has no site 'annex', or the account may not see it"));
  EXPECT_THAT(problem_of(page.get("/sites/barn/" + proposed)), HasSubstr("or the account may not read it"));
  const json reviews = page.get("/sites/barn/" + accepted).json().at("reviews");
  for (const char* const act : {"accept", "reject", "rollback"}) {
    const std::string refused = fmt::format("permission denied for function {} for the account robot_barn", act);
    EXPECT_THAT(reviews.at(act).at("refusal").get<std::string>(), StartsWith(refused));
    for (const std::string& id : {accepted, proposed}) {
      EXPECT_THAT(problem_of(page.post("/sites/barn/" + id + "/" + act, reason("x"))), HasSubstr(refused));
    }
  }
  EXPECT_EQ(state_of(accepted) + " " + state_of(proposed), "accepted proposed");
  EXPECT_EQ(value("SELECT count(*) FROM byre.event"), "4");
}

TEST_F(RegistryReviewPage, RefusesReviewsWithoutAUsableReason) {
  const std::string id = propose("barn");
  const WebClient page = serve("reviewer");
  const std::string longest(2000, 'a');
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "request: is not JSON"},
      {"[\"reason\"]", "request: is not JSON"},
      {"{\"why\": \"x\"}", "request: is not JSON"},
      {"{\"reason\": 7}", "request: is not JSON"},
      {"{\"reason\": \"\xff\"}", "request: is not JSON"},
      {reason(""), "reason: is missing"},
      {reason(" \n"), "reason: is missing"},
      {reason(longest.substr(0, 1001)), "reason: has 1001 characters, of 1000 at most"},
      {reason(std::string("x\0y", 3)), "reason: has a null character"},
  };
  for (const auto& [body, message] : cases) {
    const WebClient::Answer answer = page.post("/sites/barn/" + id + "/accept", body);
    EXPECT_EQ(answer.status, 400) << body;
    EXPECT_THAT(problem_of(answer), HasSubstr(message));
  }
  EXPECT_EQ(state_of(id), "proposed");
  std::string umlauts;
  for (int i = 0; i < 1000; ++i) umlauts += "ä";
  EXPECT_EQ(page.post("/sites/barn/" + id + "/accept", reason(umlauts)).status, 200);
  EXPECT_EQ(value("SELECT length(reason) FROM byre.version"), "1000");
}

TEST_F(RegistryReviewPage, TakesSqlAndSlashesInNamesAsNames) {
  const std::string nasty = "'; DROP SCHEMA byre CASCADE; --/../ä%41";
  const std::string encoded = "%27%3B%20DROP%20SCHEMA%20byre%20CASCADE%3B%20--%2F..%2F%C3%A4%2541";
  connect().run("UPDATE byre.site SET name = $1 WHERE id = 1", {nasty});
  const std::string id = propose("barn");
  const WebClient page = serve("reviewer");
  EXPECT_EQ(page.get("/sites/" + encoded).json().at("site"), nasty);
  EXPECT_THAT(problem_of(page.get("/sites/" + encoded + "/x'%20OR%20'1'='1")),
              HasSubstr("has no version x' OR '1'='1"));
  EXPECT_THAT(problem_of(page.post("/sites/" + encoded + "/x'%20OR%20'1'='1/accept", reason("x"))),
              HasSubstr("version x' OR '1'='1 is not proposed"));
  EXPECT_EQ(page.post("/sites/" + encoded + "/" + id + "/accept", reason(nasty)).status, 200);
  EXPECT_EQ(value("SELECT reason FROM byre.version"), nasty);
}

TEST_F(RegistryReviewPage, ExplainsUnknownIds) {
  const std::string id = propose("barn");
  const WebClient page = serve("reviewer");
  const std::string unknown = "0123456789abcdef";
  EXPECT_THAT(problem_of(page.get("/sites/bran")), HasSubstr("has no site 'bran'"));
  EXPECT_THAT(problem_of(page.get("/sites/barn/" + unknown)), HasSubstr("has no version " + unknown));
  EXPECT_THAT(problem_of(page.post("/sites/bran/" + id + "/accept", reason("x"))), HasSubstr("has no site 'bran'"));
  EXPECT_THAT(problem_of(page.post("/sites/annex/" + id + "/accept", reason("x"))),
              HasSubstr("version " + id + " is not proposed"));
  EXPECT_THAT(problem_of(page.post("/sites/barn/" + unknown + "/reject", reason("x"))), HasSubstr("is not proposed"));
  EXPECT_EQ(page.post("/sites/barn/" + id + "/remove", reason("x")).status, 404);
  EXPECT_EQ(page.post("/sites/barn/" + id, reason("x")).status, 404);
  EXPECT_EQ(page.get("/sites/barn/" + id + "/accept").status, 404) << "GET changes nothing";
  EXPECT_EQ(page.get("/passwords").status, 404);
  EXPECT_EQ(page.get("/maps/barn").status, 404);
  EXPECT_EQ(state_of(id), "proposed");
}

TEST_F(RegistryReviewPage, RefusesRequestsOfOtherPages) {
  const std::string id = propose("barn");
  const std::string target = "/sites/barn/" + id + "/accept";
  const WebClient page = serve("reviewer");
  const std::vector<WebClient::Headers> foreign = {
      {{"Origin", "http://elsewhere.example"}},
      {{"Origin", "null"}},
      {{"Host", "elsewhere.example"}},  // DNS rebinding
      {{"Host", "elsewhere.example"}, {"Origin", "http://elsewhere.example"}},
      {{"Host", fmt::format("localhost:{}", port_)}, {"Origin", "http://localhost:1"}}};
  for (const WebClient::Headers& headers : foreign) {
    EXPECT_EQ(page.request("POST", target, reason("x"), headers).status, 403);
  }
  EXPECT_EQ(state_of(id), "proposed");
  const std::string own = fmt::format("localhost:{}", port_);
  EXPECT_EQ(page.request("POST", target, reason("x"), {{"Host", own}, {"Origin", "http://" + own}}).status, 200);
}

TEST_F(RegistryReviewPage, RequiresTheTokenFromTheNetwork) {
  const std::string id = propose("barn");
  const std::string target = "/sites/barn/" + id + "/accept";
  const WebClient page = serve("reviewer", "0.0.0.0");
  EXPECT_THAT(token_, StartsWith("?token="));
  EXPECT_EQ(page.post(target, reason("x")).status, 403);
  EXPECT_EQ(page.post(target + token_ + "0", reason("x")).status, 403);
  EXPECT_EQ(page.get("/sites").status, 403);
  EXPECT_EQ(state_of(id), "proposed");
  EXPECT_EQ(page.post(target + token_, reason("x")).status, 200);
}

TEST_F(RegistryReviewPage, NotifiesItsListenersOfChanges) {
  const WebClient page = serve("reviewer");
  LiveClient listener(port_);
  std::size_t seen = listener.next().json().at("changed");  // the state at the start
  const auto is_notified = [&] {
    const std::size_t before = std::exchange(seen, listener.next().json().at("changed"));
    return seen > before;
  };
  const std::string id = propose("barn");
  EXPECT_TRUE(is_notified());
  connect("reviewer").run("SELECT byre.reject(1, $1, 'no gate')", {id});
  EXPECT_TRUE(is_notified());
  connect("reviewer").run("INSERT INTO byre.job (site, kind) VALUES (1, 'update')");
  EXPECT_TRUE(is_notified());
  connect("robot_barn").run("UPDATE byre.robot SET waiting = 3");
  EXPECT_TRUE(is_notified());
}

TEST_F(RegistryReviewPage, ReconnectsToTheRegistry) {
  const WebClient page = serve("reviewer");
  LiveClient listener(port_);
  listener.next();
  connect().run("SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE usename = 'reviewer'");
  listener.next();  // the loss
  const WebClient::Answer lost = page.get("/sites");
  EXPECT_EQ(lost.status, 503);
  EXPECT_THAT(problem_of(lost), AllOf(StartsWith("registry "), HasSubstr("the connection broke")));
  EXPECT_EQ(page.get("/sites").json().size(), 2u);
  const std::string id = propose("barn");
  listener.next();
  EXPECT_EQ(page.post("/sites/barn/" + id + "/accept", reason("x")).status, 200);
}

TEST_F(RegistryReviewPage, ReportsAServerThatDoesNotAnswer) {
  CuttingProxy proxy(RegistryServer::shared().folder() / "socket" / ".s.PGSQL.5432");
  const WebClient page = serve_from(proxy.uri(database_, "reviewer"));
  EXPECT_EQ(page.get("/sites").status, 200);
  proxy.be_silent(true);
  const WebClient::Answer silent = page.get("/sites");
  EXPECT_EQ(silent.status, 503);
  EXPECT_THAT(problem_of(silent), HasSubstr("the connection broke: no answer within 5 s"));
  EXPECT_EQ(page.get("/sites").status, 503) << "nor to a new connection";
  proxy.be_silent(false);
  EXPECT_EQ(page.get("/sites").json().size(), 2u);
}

TEST_F(RegistryReviewPage, IsNotStoppedByALockOfAnotherClient) {
  const std::string id = propose("barn");
  const WebClient page = serve("reviewer");
  Connection other = connect();
  other.run_script("BEGIN; LOCK TABLE byre.version IN EXCLUSIVE MODE");
  EXPECT_THAT(problem_of(page.post("/sites/barn/" + id + "/accept", reason("x"))),
              HasSubstr("is in use by another client"));
  other.run("ROLLBACK");
  EXPECT_EQ(page.post("/sites/barn/" + id + "/accept", reason("x")).status, 200);
}

TEST_F(RegistryReviewPage, ShowsAMapOnThePlanThatItIsRegisteredOn) {
  write("plan.pgm", "P5\n2 1\n255\n\xff\x01");
  write("plan.yaml", "image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  Connection reviewer = connect("reviewer");
  const auto registered_on = [&](const std::string& plan) {
    StoredMap map;
    map.plan.emplace();
    map.plan->plan = plan;
    save_map(map, folder_ / (plan + ".byre"));
    return push_file(reviewer, kBarn, folder_ / (plan + ".byre"), "").id;
  };
  const std::string on_plan = registered_on("plan.yaml"), on_another = registered_on("another.yaml");
  const auto expect_plan = [&](const WebClient& page, std::size_t width, const std::string& note) {
    const json scene = scene_of(page, on_plan);
    EXPECT_EQ(scene.at("plan").at("name"), "plan.yaml");
    EXPECT_EQ(scene.at("plan").at("width"), width);
    EXPECT_THAT(scene.at("plan_note").get<std::string>(), testing::MatchesRegex(note));
    EXPECT_EQ(page.get("/maps/barn/" + on_plan + "/plan.png").content_type, "image/png");
    EXPECT_TRUE(scene_of(page, on_another).at("plan").is_null());
  };
  expect_plan(serve("reviewer", "127.0.0.1", {"--plan", (folder_ / "plan.yaml").string()}), 2, "");
  end_page();
  EXPECT_EQ(scene_of(serve("reviewer"), on_plan).at("plan_note"),
            "The registry has no current plan plan.yaml, on which the map is registered.");
  end_page();
  std::filesystem::create_directories(folder_ / "registry");
  write("registry/plan.pgm", "P5\n3 1\n255\n\xff\x01\xff");
  write("registry/plan.yaml", read("plan.yaml"));
  push_plan(reviewer, kBarn, folder_ / "registry/plan.yaml", "ground", "");
  const WebClient page = serve("reviewer");
  expect_plan(page, 3, "Floor plan ground 1 .plan.yaml., added by reviewer at 20[-0-9T:]+Z");
  const json plans = page.get("/sites/barn").json().at("plans");
  EXPECT_EQ(plans.at(0).at("name"), "ground");
  EXPECT_EQ(plans.at(0).at("added_by"), "reviewer");
  end_page();
  expect_plan(serve("reviewer", "127.0.0.1", {"--plan", (folder_ / "plan.yaml").string()}), 2, "");
}

TEST_F(RegistryReviewPage, ShowsAMapWithItsChanges) {
  const std::string first = propose("first"), second = propose("second", {first, "0123456789abcdef"});
  const std::string orphan = propose("orphan", {"0123456789abcdef"});
  const WebClient page = serve("reviewer");
  const std::string map = "/maps/barn/" + second + "/";
  EXPECT_THAT(page.get(map).content_type, StartsWith("text/html"));
  const json scene = scene_of(page, second);
  EXPECT_EQ(scene.at("name"), "barn " + second);
  EXPECT_EQ(scene.at("before"), first);
  EXPECT_EQ(scene.at("is_read_only"), true);
  EXPECT_EQ(page.get(map + "map/changes").status, 200);
  EXPECT_EQ(page.get(map + "map/offline").body.size(), 8u) << "counts of a map without points";
  EXPECT_EQ(page.post(map + "save", "{}").status, 404);
  const json alone = scene_of(page, orphan);
  EXPECT_TRUE(alone.at("before").is_null());
  EXPECT_THAT(alone.at("next_step").get<std::string>(), HasSubstr("does not have its parent 0123456789abcdef"));
  for (const std::string& unknown : {"0123456789abcdef", "..%2F..%2Fetc"}) {
    EXPECT_THAT(scene_of(page, unknown).at("problem").get<std::string>(), HasSubstr("has no version"));
  }
  for (const std::string& each : {propose("third"), propose("fourth"), first}) {
    EXPECT_EQ(scene_of(page, each).at("name"), "barn " + each) << "more than are kept in memory";
  }
}

TEST_F(RegistryReviewPage, IsNotServedWithoutARegistry) {
  EXPECT_EQ(run("registry serve --port 0 --registry 'host=/nowhere dbname=byre'").exit_code, 1);
  EXPECT_THAT(registry("serve --port 0 --bind barn", "reviewer").errors, HasSubstr("is not an IP address"));
  const cli::Outcome outsider = registry("serve --port 0", "outsider");
  EXPECT_EQ(outsider.exit_code, 3);
  EXPECT_THAT(outsider.errors, HasSubstr("for the account outsider"));
  EXPECT_THAT(outsider.output, IsEmpty());
}

}  // namespace
}  // namespace byre
