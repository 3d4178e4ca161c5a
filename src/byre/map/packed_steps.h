#pragma once

#include "byre/input/byte_stream.h"
#include "byre/map/map_quanta.h"

namespace byre {

// The steps of a patch in fewer bytes, as they mostly differ little from what their neighbours let expect: a byte with
// the number of bytes that follow, then these (docs/map_format.md, "patches"). A patch that would not gain has its
// steps as they are.
using PatchSteps = decltype(PatchCode::steps);
void write_packed_steps(const PatchSteps& steps, ByteWriter& writer);
PatchSteps read_packed_steps(ByteReader& reader);
void skip_packed_steps(ByteReader& reader);  // whatever they are

}  // namespace byre
