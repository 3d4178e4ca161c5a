#include "byre/ros2/dds/cdr_type.h"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

namespace byre {
namespace {

// Callbacks for threads of Cyclone DDS, which is C: they throw no exceptions; a null pointer means out of memory.

struct CdrType : ddsi_sertype {
  std::size_t max_bytes = 0;  // longer received messages are dropped
};

std::size_t max_bytes_of(const ddsi_sertype* type) {
  return static_cast<const CdrType*>(type)->max_bytes;
}

struct Sample : ddsi_serdata {
  std::vector<std::byte> bytes;  // padded to a multiple of four, as Cyclone may read that far
  std::size_t size = 0;          // bytes without padding
};

const Sample& sample_of(const ddsi_serdata* data) {
  return *static_cast<const Sample*>(data);
}

std::size_t padded(std::size_t size) {
  return (size + 3) / 4 * 4;
}

Sample* new_sample(const ddsi_sertype* type, ddsi_serdata_kind kind) {
  auto* const sample = new Sample;
  ddsi_serdata_init(sample, type, kind);
  return sample;
}

// Null if out of memory, or if fill finds the bytes incomplete.
template <typename Fill>
ddsi_serdata* filled_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size,
                            const Fill& fill) noexcept {
  if (size > max_bytes_of(type)) return nullptr;
  try {
    std::unique_ptr<Sample> sample(new_sample(type, kind));
    sample->bytes.resize(padded(size));
    sample->size = size;
    return fill(std::span(sample->bytes).first(size)) ? sample.release() : nullptr;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool equal_keys(const ddsi_serdata*, const ddsi_serdata*) {
  return true;  // without keys, all are equal
}

std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(sample_of(data).size);
}

// Fragments are in order, complete from the first byte, and may overlap.
bool gather(const nn_rdata* fragment, std::span<std::byte> bytes) {
  std::size_t done = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->min > done || fragment->maxp1 > bytes.size()) return false;
    if (fragment->maxp1 <= done) continue;
    const unsigned char* const payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(bytes.data() + done, payload + (done - fragment->min), fragment->maxp1 - done);
    done = fragment->maxp1;
  }
  return done == bytes.size();
}

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* first,
                             std::size_t size) {
  return filled_sample(type, kind, size, [first](std::span<std::byte> bytes) { return gather(first, bytes); });
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  return filled_sample(type, kind, size, [count, pieces](std::span<std::byte> bytes) {
    std::size_t done = 0;
    for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
      const std::size_t length = std::min<std::size_t>(pieces[i].iov_len, bytes.size() - done);
      std::memcpy(bytes.data() + done, pieces[i].iov_base, length);
      done += length;
    }
    return done == bytes.size();
  });
}

ddsi_serdata* without_bytes(const ddsi_sertype* type) {
  return filled_sample(type, SDK_KEY, 0, [](std::span<std::byte>) { return true; });
}

ddsi_serdata* from_key_hash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return without_bytes(type);
}

// Messages are passed as bytes only; Cyclone requests empty ones on disposal.
ddsi_serdata* from_struct(const ddsi_sertype* type, ddsi_serdata_kind kind, const void*) {
  return kind == SDK_KEY ? without_bytes(type) : nullptr;
}

void copy_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* to) {
  assert(offset + size <= sample_of(data).bytes.size());
  std::memcpy(to, sample_of(data).bytes.data() + offset, size);
}

ddsi_serdata* lend_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* lent) {
  assert(offset + size <= sample_of(data).bytes.size());
  lent->iov_base = const_cast<std::byte*>(sample_of(data).bytes.data()) + offset;
  lent->iov_len = size;
  return ddsi_serdata_ref(data);
}

void take_bytes_back(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

bool to_struct(const ddsi_serdata*, void*, void**, void*) {
  return false;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  ddsi_serdata* const key = without_bytes(data->type);
  if (key != nullptr) key->type = nullptr;
  return key;
}

bool untyped_to_struct(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}

void free_sample(ddsi_serdata* data) {
  delete static_cast<Sample*>(data);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* text, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(text, size, "%u bytes", size_of(data)));
}

void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash, 0, sizeof *hash);
}

const ddsi_serdata_ops kSampleCallbacks = {
    equal_keys,  size_of,    from_fragments,  from_pieces, from_key_hash, from_struct,
    copy_bytes,  lend_bytes, take_bytes_back, to_struct,   to_untyped,    untyped_to_struct,
    free_sample, print,      key_hash,        nullptr,     nullptr};

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete static_cast<CdrType*>(type);
}

void zero_structs(const ddsi_sertype*, void*, std::size_t) {}

void resize_structs(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}

void free_structs(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

bool equal_types(const ddsi_sertype* one, const ddsi_sertype* other) {
  return max_bytes_of(one) == max_bytes_of(other);  // called for equal names only
}

std::uint32_t hash_type(const ddsi_sertype* type) {
  return static_cast<std::uint32_t>(max_bytes_of(type));  // combined with the hash of the name
}

const ddsi_sertype_ops kTypeCallbacks = {ddsi_sertype_v0, nullptr,     free_type, zero_structs, resize_structs,
                                         free_structs,    equal_types, hash_type, nullptr,      nullptr,
                                         nullptr,         nullptr,     nullptr,   nullptr};

}  // namespace

ddsi_sertype* make_cdr_type(const std::string& dds_type_name, std::size_t max_bytes) {
  auto* const type = new CdrType;
  type->max_bytes = max_bytes;
  ddsi_sertype_init_flags(type, dds_type_name.c_str(), &kTypeCallbacks, &kSampleCallbacks,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

ddsi_serdata* make_cdr_sample(const ddsi_sertype* type, std::vector<std::byte> message) noexcept {
  try {
    Sample* const sample = new_sample(type, SDK_DATA);
    sample->size = message.size();
    sample->bytes = std::move(message);
    sample->bytes.resize(padded(sample->size));
    return sample;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

std::span<const std::byte> bytes_of(const ddsi_serdata& sample) {
  return std::span(sample_of(&sample).bytes).first(sample_of(&sample).size);
}

}  // namespace byre
