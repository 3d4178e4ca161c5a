#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

struct ddsi_serdata;
struct ddsi_sertype;

namespace byre {

// Messages as Cyclone DDS is to carry them for byre: bytes that it does not look into. All types are as those of ROS 2,
// without keys and in the first version of the encoding (XCDR1). A message is four bytes that name the encoding and its
// byte order, then its fields.

// A type for dds_create_topic_sertype, which takes ownership. Received messages of more than most_bytes are dropped.
ddsi_sertype* make_cdr_type(const std::string& dds_type_name, std::size_t most_bytes);

// A message of a topic's type for dds_writecdr, which takes it over; null without memory.
ddsi_serdata* make_cdr_sample(const ddsi_sertype* type, std::vector<std::byte> message) noexcept;

// What dds_takecdr gave, as long as that is kept; empty for news about a writer.
std::span<const std::byte> bytes_of(const ddsi_serdata& sample);

}  // namespace byre
