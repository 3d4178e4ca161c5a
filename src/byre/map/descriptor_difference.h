#pragma once

#include "byre/base/byte_stream.h"
#include "byre/features.h"

namespace byre {

// Code of a view's descriptor: the bits that differ from the descriptor of its point. A byte with their number, then
// half bytes, low half first: the number of equal bits before each differing bit; 15 means 15 equal bits, continued in
// the next half byte. If the descriptor is shorter, the number is 255 and the descriptor follows.
void write_difference(const Descriptor& descriptor, const Descriptor& from, ByteWriter& writer);
Descriptor read_difference(ByteReader& reader, const Descriptor& from);

}  // namespace byre
