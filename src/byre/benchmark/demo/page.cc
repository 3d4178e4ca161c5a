#include "byre/benchmark/demo/page.h"

#include "byre/base/enum_names.h"
#include "byre/base/markup.h"
#include "byre/base/report_row.h"
#include "byre/benchmark/demo/table.h"
#include "byre/benchmark/demo/timeline.h"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --paper: #fdfdfb; --card: #ffffff; --ink: #1f2328; --faint: #656d76; --rule: #d8dde2;
  --wash: #f1f4f2; --accent: #17663a; --offline: #1b9e4b; --online: #8e44ad; --hybrid: #c7322e; --localise: #d98a00;
  --nomap: #0072b2; --trusted: #2f9e55; --degraded: #e69100; --untrusted: #cf222e; --none: #e3e6e9; --off: #8c959f24; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #14171a; --card: #1c2024; --ink: #e6e8ea; --faint: #9aa4ae; --rule: #343a41; --wash: #1f2a24;
    --accent: #6fd39a; --offline: #45c876; --online: #c58be0; --hybrid: #ff6d66; --localise: #ffb53e; --nomap: #5cb8f0;
    --trusted: #3fb56a; --degraded: #f0a830; --untrusted: #f05b62; --none: #2c3238; --off: #aab4be22; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 1.0625rem/1.6 system-ui, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; }
main { max-width: 68rem; margin: 0 auto; padding: 3.5rem 1.25rem 4rem; }
h1 { font-size: clamp(2rem, 5vw, 3rem); line-height: 1.1; letter-spacing: -0.02em; margin: 0.2em 0 0.5em; }
h2 { font-size: 1.45rem; letter-spacing: -0.01em; margin: 3.2rem 0 0.6rem; }
p, li { max-width: 44rem; }
.eyebrow { color: var(--accent); font-weight: 600; letter-spacing: 0.04em; margin: 0; }
.lead { font-size: 1.25rem; line-height: 1.5; }
.key { display: grid; grid-template-columns: repeat(auto-fit, minmax(13rem, 1fr)); gap: 1rem; margin: 2rem 0 0; }
.key div { display: flex; flex-direction: column-reverse; justify-content: flex-end; background: var(--wash);
  border-radius: 0.75rem; padding: 1rem 1.25rem; }
.key dt { color: var(--faint); font-size: 0.9rem; line-height: 1.35; }
.key dd { margin: 0; font-size: 2rem; font-weight: 650; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; min-width: 38rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.55rem 0.8rem; border-bottom: 1px solid var(--rule); text-align: right; vertical-align: top; }
th:first-child { text-align: left; font-weight: 400; padding-left: 0; }
thead th { font-weight: 650; border-bottom: 2px solid var(--ink); }
thead th small { display: block; color: var(--faint); font-weight: 400; }
td.best { color: var(--accent); font-weight: 650; }
figure { margin: 1.25rem 0 0; }
figure img, .timeline { display: block; width: 100%; height: auto; border: 1px solid var(--rule); border-radius: 0.75rem;
  background: var(--card); }
figure img { background: #ffffff; }
figcaption, .note, footer { color: var(--faint); font-size: 0.95rem; max-width: 44rem; margin-top: 0.7rem; }
.legend { display: flex; flex-wrap: wrap; gap: 0.3rem 1.3rem; padding: 0; margin: 0.8rem 0 0; list-style: none;
  font-size: 0.95rem; }
.legend i { display: inline-block; width: 1.3em; height: 0.6em; border-radius: 0.2em; margin-right: 0.45em; }
footer { border-top: 1px solid var(--rule); margin-top: 4rem; padding-top: 1rem; }
.timeline { padding: 0.5rem; font-size: 13px; }
.timeline text { fill: var(--ink); }
.timeline .title { font-weight: 600; }
.timeline .end { text-anchor: end; }
.timeline .middle { text-anchor: middle; }
.timeline .faint { fill: var(--faint); }
.timeline .grid { stroke: var(--rule); stroke-width: 1; }
.timeline .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; }
.timeline .off { fill: var(--off); }
.timeline .trusted { fill: var(--trusted); }
.timeline .degraded { fill: var(--degraded); }
.timeline .untrusted { fill: var(--untrusted); }
.timeline .none { fill: var(--none); }
.timeline .offline { stroke: var(--offline); }
.timeline .online { stroke: var(--online); }
.timeline .hybrid { stroke: var(--hybrid); }
.timeline .localise_only { stroke: var(--localise); }
.timeline .no_map { stroke: var(--nomap); }
.timeline .sigma { stroke: var(--faint); stroke-dasharray: 5 4; }
)";

constexpr const char* kExplanation = R"(
<h2>Scenario</h2>
<p><b>The first visit</b> is by day. The robot drives along the feed alley once, and byre makes a map of it: points with
descriptors, positions and covariances. The map is registered on the floor plan by signs that were picked in both.</p>
<p><b>The second visit</b> is at dusk, by lamplight. Half of the buckets, bales and barrows have moved, the feed lies in
other heaps, more cows walk about, and a gate is open that was closed: the robot turns round in an unmapped store. It is
switched on in the middle of the alley, at a place that no run is given.</p>
<p><b>Hybrid</b> localisation finds its place in the offline map, tracks the points of that map (green) that are still in
place, maps new points online (purple), and rejects points that have moved. Off the map the online points constrain the
pose; when points of the offline map come into view again, it is back on them without a jump. <b>No map</b> is plain
SLAM. Its path starts at zero and has no place on the plan; to draw it at all, the whole path is laid on the truth by the
best fit afterwards, which a robot cannot do and which makes its error as small as it can be. <b>Localise only</b> tracks
the offline map and maps nothing. It has a position while enough points of the map are visible. Behind the gate there
are none, and the bays of the barn look alike, so that a wrong one may be found.</p>
<p>Each pose has a verdict. Trusted means an expected error below 20 cm. The truth comes from the simulation and is used
for evaluation only.</p>
)";

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name.substr(0, name.find(' ')) + ">";
}

const DemoArm* find_hybrid(const DemoFindings& findings) {
  const auto found = std::ranges::find(findings.arms, Arm::hybrid, &DemoArm::arm);
  return found != findings.arms.end() ? &*found : nullptr;
}

std::string percent(const Figure& share) {
  return share ? fmt::format("{:.1f} %", 1e2 * *share) : "-";
}

std::string key_figure(const std::string& value, const std::string& meaning) {
  return "<div>" + element("dt", meaning) + element("dd", value) + "</div>\n";
}

std::string figure(const char* id, const std::string& svg, const std::string& alternative, const std::string& caption) {
  return "<figure id=\"" + std::string(id) + "\"><img alt=\"" + markup_escaped(alternative) + "\" src=\"" +
         data_address(svg) + "\"><figcaption>" + caption + "</figcaption></figure>\n";
}

std::string mission_figure(const DemoFindings& findings) {
  return figure(
      "mission", to_svg(findings.mission_picture), "Floor plan with the positions of three runs",
      "Colours show the error of each published position, which the simulation measures exactly. Where the true "
      "path is bare, the run had no position. Falsely trusted: frames reported as trusted, but off by more than 20 "
      "cm.");
}

std::string header(const DemoFindings& findings) {
  std::string html = "<p class=\"eyebrow\">byre " BYRE_VERSION " &middot; a demonstration</p>\n";
  html += "<h1>Switched on somewhere in a barn</h1>\n";
  const DemoArm* const hybrid = find_hybrid(findings);
  if (hybrid == nullptr) return html;
  html +=
      "<p class=\"lead\">A robot has mapped a barn once, by day. Now it is switched on at an unknown place: it is "
      "dusk, "
      "half of the things have moved, and part of the way leads off the map. With its map it finds its place on the "
      "floor "
      "plan and keeps it. Without a map it has none.</p>\n" +
      mission_figure(findings) + "<dl class=\"key\">\n";
  const PlanFigures figures = plan_figures(*hybrid);
  if (figures.found_s)
    html += key_figure(fmt::format("{:.1f} s", *figures.found_s), "until the first trusted position");
  html += key_figure(percent(figures.close_share), "of all frames within 10 cm of the truth, as published");
  html += key_figure(percent(figures.trusted_share), "reported as trusted");
  html += key_figure(std::to_string(figures.wrong), "frames trusted with an error above 20 cm");
  if (hybrid->measures.cost.frame_ms_mean) {
    html += key_figure(fmt::format("{:.0f} ms", *hybrid->measures.cost.frame_ms_mean),
                       "per stereo pair of the run, on this machine");
  }
  return html + "</dl>\n";
}

std::string about(Arm arm) {
  return std::string(name_among<Arm::hybrid>(
      {"plain SLAM, from zero", "on the offline map only", "on the offline map, with an online map"}, arm));
}

std::string table(const DemoFindings& findings) {
  std::string html =
      "<h2>Three ways to run the second visit</h2>\n<div class=\"wide\"><table id=\"arms\">\n<thead><tr><th></th>";
  for (const DemoArm& arm : findings.arms) {
    html += element("th", shown_name(arm.arm) + element("small", about(arm.arm)));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const DemoRow& row : demo_table(findings.arms)) {
    html += "<tr>" + element("th scope=\"row\"", markup_escaped(row.measure));
    for (const DemoCell& cell : row.cells) {
      html += element(cell.is_best ? "td class=\"best\"" : "td", markup_escaped(cell.text));
    }
    html += "</tr>\n";
  }
  return html +
         "</tbody></table></div>\n<p class=\"note\">No run is given a true pose. Errors are on the floor plan, over "
         "the "
         "frames with a position, without alignment to the truth; only in the row \"path after alignment\" each path "
         "is "
         "aligned to the truth, which is the only error that a run without a map has. "
         "<i>Published</i> positions are causal, <i>final</i> positions are corrected after the last frame. Frames "
         "were fed as fast as they were processed; the time per frame includes waiting for mapping.</p>\n";
}

std::string plan_section(const DemoFindings& findings) {
  return "<h2>Map and verdicts</h2>\n" +
         figure(
             "plan", findings.plan_picture, "Floor plan with map points and paths",
             "Map points of the first visit are green, those of the second purple. The path of the hybrid run is "
             "coloured by verdict. " +
                 fmt::format("The map has {} keyframes and {} points; ", findings.map_keyframes, findings.map_points) +
                 fmt::format("it is registered on the plan by {} exactly picked signs. ", findings.picks) +
                 fmt::format("Its mapping path has an error of {:.1f} cm (ATE, {} frames).", 1e2 * findings.map_ate,
                             findings.map_frames));
}

std::string camera_section(const DemoFindings& findings) {
  if (!findings.camera_s) return "";
  return "<h2>Camera image</h2>\n" +
         figure("camera", findings.camera_picture, "Camera image with matched map points",
                fmt::format("After {:.1f} s. ", *findings.camera_s) +
                    "Green: points of the offline map that are still in place. Purple: points of the online map. "
                    "Crosses are outliers. The blue wedge on the plan shows the camera pose.");
}

std::string sign(const char* colour, const char* meaning) {
  return std::string("<li><i style=\"background:var(--") + colour + ")\"></i>" + meaning + "</li>";
}

std::string timeline_section(const DemoFindings& findings) {
  return "<h2>Health over time</h2>\n<ul class=\"legend\">" + sign("trusted", "trusted") +
         sign("degraded", "degraded") + sign("untrusted", "untrusted") + sign("none", "no position") +
         sign("offline", "points of the offline map") + sign("online", "points of the online map") +
         sign("nomap", "error: no map") + sign("localise", "error: localise only") + sign("hybrid", "error: hybrid") +
         sign("faint", "estimated error of the hybrid run (one sigma, dashed)") + "</ul>\n<figure id=\"health\">\n" +
         demo_timeline(findings) + "</figure>\n";
}

std::string footer(const DemoFindings& findings) {
  return "<footer>Made by <code>byre demo</code> in " + format_duration(findings.total_s) + ", of which " +
         format_duration(findings.rendering_s) +
         " for rendering both visits. The recordings, the map and the trajectories are in the folder of this "
         "page.</footer>\n";
}

bool stays_in_address(char character) {
  constexpr std::string_view kPlain = "-_.!~*() ,;=/?@$";
  return std::isalnum(static_cast<unsigned char>(character)) != 0 || kPlain.find(character) != std::string_view::npos;
}

}  // namespace

std::string data_address(const std::string& svg) {
  std::string address = "data:image/svg+xml,";
  for (const char character : svg) {
    if (stays_in_address(character)) {
      address += character;
    } else {
      address += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(character)));
    }
  }
  return address;
}

std::string demo_page(const DemoFindings& findings) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<title>byre: switched on somewhere in a barn</title>\n<style>" +
         std::string(kStyle) + "</style>\n</head>\n<body>\n<main>\n<header>\n" + header(findings) + "</header>\n" +
         table(findings) + plan_section(findings) + camera_section(findings) + timeline_section(findings) +
         kExplanation + footer(findings) + "</main>\n</body>\n</html>\n";
}

}  // namespace byre
