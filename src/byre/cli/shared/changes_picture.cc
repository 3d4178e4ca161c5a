#include "byre/cli/shared/changes_picture.h"

#include "byre/cli/shared/arguments.h"
#include "byre/input_error.h"
#include "byre/viewer/palette.h"
#include "byre/viewer/plan_picture.h"

namespace byre::cli {

void declare_changes_picture(CLI::App& command, ChangesPicture& picture) {
  CLI::Option* const file = add_output(command, Output::picture, "--picture", picture.file,
                                       "Picture of the changes from above: .svg or .png");
  add_input(command, Input::plan, "--plan", picture.plan, "Floor plan under the picture")->needs(file);
}

void write_changes(const Map& before, const Map& after, const MapDifference& difference, const std::string& title,
                   const ChangesPicture& picture) {
  if (!picture.file) return;
  if (picture.plan && !after.plan()) {
    throw InputError(picture.plan->string(), "cannot be drawn, because the map is not registered on a floor plan",
                     "see \"byre register\"");
  }
  PlanScene scene;
  scene.title = title;
  scene.ground = ground_of(after.stored(), picture.plan ? std::optional(read_floor_plan(*picture.plan)) : std::nullopt);
  scene.map = scene_of(before, after, difference);
  scene.map.keyframes = scene_of(after.stored().map).keyframes;
  scene.offline = {"removed points", palette::kUntrusted};
  scene.online = {"added points", palette::kTrusted};
  write_picture(plan_picture(scene), *picture.file);
}

}  // namespace byre::cli
