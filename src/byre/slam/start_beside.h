#pragma once

#include "byre/slam/initialisation.h"

#include <optional>
#include <vector>

namespace byre {

// Where the two cameras of a first map of one camera stood in a map that there is already, as wheels tell it. What is
// told of the way between them is how the start learns its scale.
struct StartPlaces {
  Pose first_camera_from_world;
  Pose second_camera_from_world;
};

// Adds the keyframes and points of a start to a map: the first camera where it is told to have stood, all lengths by
// the way that is told. parent: of the first keyframe, from which the way was told. Gives the two keyframes; none, and
// nothing is added, where the cameras turned or moved otherwise than is told.
std::vector<KeyframeId> add_beside(const MonocularStart& start, const StartPlaces& told,
                                   const std::optional<KeyframeId>& parent, int recording, Map& map);

// The first map of all moved to where its second camera is told to stand, in the lengths of the way that is told. It is
// told before it is known how wheels are mounted, so which way that went counts for nothing. Where the camera turned so
// much that an arm by which it sits off the axle would change its way, lengths stay what they are.
MonocularStart placed(const MonocularStart& start, const StartPlaces& told);

}  // namespace byre
