#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

struct ddsi_serdata;
struct ddsi_sertype;

namespace byre {

// Cyclone DDS type for messages as opaque bytes. All types are those of ROS 2: without keys, in XCDR1. A message is
// four bytes for encoding and byte order, then its fields.

// Type for dds_create_topic_sertype, which takes ownership. Longer received messages than max_bytes are dropped.
ddsi_sertype* make_cdr_type(const std::string& dds_type_name, std::size_t max_bytes);

// Message of a topic's type for dds_writecdr, which takes ownership; null if out of memory.
ddsi_serdata* make_cdr_sample(const ddsi_sertype* type, std::vector<std::byte> message) noexcept;

// Bytes of a sample from dds_takecdr, valid as long as it is; empty for a change of a writer's state.
std::span<const std::byte> bytes_of(const ddsi_serdata& sample);

}  // namespace byre
