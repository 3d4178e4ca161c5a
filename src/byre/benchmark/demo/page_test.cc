#include "byre/benchmark/demo/page.h"

#include "byre/benchmark/demo/findings_scene.h"

#include <regex>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// Elements that are not closed in their order, or closed but not open.
std::vector<std::string> unbalanced_elements(const std::string& html) {
  std::vector<std::string> open;
  std::vector<std::string> faults;
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*?(/?)>");
  for (auto at = std::sregex_iterator(html.begin(), html.end(), tag); at != std::sregex_iterator(); ++at) {
    const std::string name = (*at)[2];
    const bool is_void = name == "meta" || name == "img";
    if (is_void || (*at)[3] == "/") continue;
    if ((*at)[1] != "/") {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      faults.push_back("/" + name);
    } else {
      open.pop_back();
    }
  }
  faults.insert(faults.end(), open.begin(), open.end());
  return faults;
}

TEST(DemoPage, ContainsTablePicturesAndTimeline) {
  const std::string html = demo_page(small_findings());
  EXPECT_THAT(html, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(html, AllOf(HasSubstr("<table id=\"arms\">"), HasSubstr("<figure id=\"mission\">"),
                          HasSubstr("<figure id=\"plan\">"), HasSubstr("<figure id=\"camera\">"),
                          HasSubstr("<svg class=\"timeline\"")));
  EXPECT_THAT(html, AllOf(HasSubstr("No map"), HasSubstr("Localise only"), HasSubstr("Hybrid")));
}

TEST(DemoPage, LeadsWithThePictureOfTheMission) {
  const std::string html = demo_page(small_findings());
  EXPECT_LT(html.find("<figure id=\"mission\">"), html.find("<h2>"));
}

TEST(DemoPage, IsSelfContained) {
  const std::string html = demo_page(small_findings());
  EXPECT_THAT(html, Not(HasSubstr("http:")));  // escaped in the pictures' data URLs
  EXPECT_THAT(html, Not(HasSubstr("https:")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  const std::regex source("(src|href)=\"(?!data:)");
  EXPECT_FALSE(std::regex_search(html, source));
}

TEST(DemoPage, ClosesItsElements) {
  EXPECT_THAT(unbalanced_elements(demo_page(small_findings())), IsEmpty());
}

TEST(DemoPage, OmitsTheCameraPictureWithoutPoses) {
  DemoFindings findings = small_findings();
  findings.camera_s.reset();
  EXPECT_THAT(demo_page(findings), Not(HasSubstr("id=\"camera\"")));
}

TEST(DemoPage, EmbedsPicturesAsDataUrls) {
  const std::string address = data_address("<svg xmlns=\"http://x\">50 % #1</svg>");
  EXPECT_EQ(address, "data:image/svg+xml,%3Csvg xmlns=%22http%3A//x%22%3E50 %25 %231%3C/svg%3E");
}

}  // namespace
}  // namespace byre
