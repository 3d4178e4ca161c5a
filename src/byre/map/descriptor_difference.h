#pragma once

#include "byre/features.h"
#include "byre/input/byte_stream.h"

namespace byre {

// A descriptor of a view, told by the bits in which it differs from another one, which is that of the point it sees.
// A byte with their number, then half bytes, the lower one of a byte first: how many bits lie between one that differs
// and the next, from the first bit on; 15 stands for 15 that do not differ, and the next half byte goes on. Where that
// takes more than the descriptor, the number is 255, and the descriptor follows.
void write_difference(const Descriptor& descriptor, const Descriptor& from, ByteWriter& writer);
Descriptor read_difference(ByteReader& reader, const Descriptor& from);

}  // namespace byre
