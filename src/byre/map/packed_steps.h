#pragma once

#include "byre/base/byte_stream.h"
#include "byre/map/map_quanta.h"

namespace byre {

// Compressed steps of a patch, by prediction from neighbours: a byte with the number of bytes that follow, then these
// (docs/reference/map_format.md, "patches"). Steps that do not compress are stored as they are.
using PatchSteps = decltype(PatchCode::steps);
void write_packed_steps(const PatchSteps& steps, ByteWriter& writer);
PatchSteps read_packed_steps(ByteReader& reader);
void skip_packed_steps(ByteReader& reader);  // without checks

}  // namespace byre
