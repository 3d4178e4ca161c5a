#include "byre/io/bag/compression.h"

#include "byre/base/output_file.h"
#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include <bzlib.h>
#include <fcntl.h>
#include <lz4frame.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

namespace byre {
namespace {

// Bytes consumed and produced by one step of a decoder.
struct Step {
  std::size_t taken = 0;
  std::size_t made = 0;
  bool is_end = false;   // end of the compressed data
  bool is_sound = true;  // false: the data is damaged
};

class ZstdDecoder {
 public:
  Step step(std::span<const std::byte> from, std::span<std::byte> to) {
    ZSTD_inBuffer input{from.data(), from.size(), 0};
    ZSTD_outBuffer output{to.data(), to.size(), 0};
    const std::size_t result = ZSTD_decompressStream(context_.get(), &output, &input);
    return {input.pos, output.pos, result == 0, ZSTD_isError(result) == 0};
  }

 private:
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context_{ZSTD_createDCtx(), ZSTD_freeDCtx};
};

class Lz4Decoder {
 public:
  Lz4Decoder() {
    LZ4F_dctx* context = nullptr;
    LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
    context_.reset(context);
  }

  Step step(std::span<const std::byte> from, std::span<std::byte> to) {
    std::size_t taken = from.size(), made = to.size();
    const std::size_t result = LZ4F_decompress(context_.get(), to.data(), &made, from.data(), &taken, nullptr);
    const bool is_sound = LZ4F_isError(result) == 0;
    return {is_sound ? taken : 0, is_sound ? made : 0, result == 0, is_sound};
  }

 private:
  std::unique_ptr<LZ4F_dctx, std::size_t (*)(LZ4F_dctx*)> context_{nullptr, LZ4F_freeDecompressionContext};
};

class Bz2Decoder {
 public:
  Bz2Decoder() { BZ2_bzDecompressInit(&stream_, 0, 0); }
  ~Bz2Decoder() { BZ2_bzDecompressEnd(&stream_); }
  Bz2Decoder(const Bz2Decoder&) = delete;
  Bz2Decoder& operator=(const Bz2Decoder&) = delete;

  Step step(std::span<const std::byte> from, std::span<std::byte> to) {
    constexpr std::size_t kMost = std::numeric_limits<unsigned>::max();
    const auto available = static_cast<unsigned>(std::min(from.size(), kMost));
    const auto room = static_cast<unsigned>(std::min(to.size(), kMost));
    stream_.next_in = reinterpret_cast<char*>(const_cast<std::byte*>(from.data()));
    stream_.avail_in = available;
    stream_.next_out = reinterpret_cast<char*>(to.data());
    stream_.avail_out = room;
    const int result = BZ2_bzDecompress(&stream_);
    return {available - stream_.avail_in, room - stream_.avail_out, result == BZ_STREAM_END,
            result == BZ_OK || result == BZ_STREAM_END};
  }

 private:
  bz_stream stream_{};
};

template <typename Decoder>
Decompressed decompress_with(std::span<const std::byte> bytes, std::size_t most) {
  constexpr std::size_t kFirst = 65536;
  Decoder decoder;
  Decompressed result;
  std::size_t made = 0;
  while (true) {
    if (made == result.bytes.size()) {
      if (made == most) break;  // one more step may still reach the end
      result.bytes.resize(std::min(most, std::max({kFirst, 2 * made, 2 * bytes.size()})));
    }
    const Step step = decoder.step(bytes, std::span(result.bytes).subspan(made));
    made += step.made;
    bytes = bytes.subspan(step.taken);
    if (!step.is_sound || step.is_end || (step.taken == 0 && step.made == 0)) {
      result.is_whole = step.is_sound && step.is_end;
      break;
    }
  }
  if (made == most && !result.is_whole) {
    std::array<std::byte, 1> beyond{};
    const Step step = decoder.step(bytes, beyond);
    result.is_whole = step.is_sound && step.is_end && step.made == 0;
  }
  result.bytes.resize(made);
  return result;
}

}  // namespace

std::vector<std::byte> read_piece(ByteSource& source, std::uint64_t begin, std::uint64_t most) {
  const std::uint64_t left = source.size() - std::min(begin, source.size());
  std::vector<std::byte> piece(std::min(most, left));
  if (!piece.empty()) source.read(begin, piece);
  return piece;
}

FileSource::FileSource(const std::filesystem::path& path) : path_(path) {
  refuse_pipe(path);
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    const std::string reason = descriptor_ < 0 || !S_ISDIR(status.st_mode) ? std::strerror(errno) : "it is a folder";
    if (descriptor_ >= 0) close(descriptor_);
    throw InputError(path.string(), "cannot be opened: " + reason, "check that the file exists and is readable");
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

FileSource::~FileSource() {
  close(descriptor_);
}

void FileSource::read_directly(std::uint64_t begin, std::span<std::byte> piece) const {
  while (!piece.empty()) {
    const ssize_t count = pread(descriptor_, piece.data(), piece.size(), static_cast<off_t>(begin));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      throw InputError(
          path_.string(),
          count < 0 ? std::string("cannot be read: ") + std::strerror(errno) : "was truncated while being read",
          "check the disk, and that no program writes to the file");
    }
    piece = piece.subspan(static_cast<std::size_t>(count));
    begin += static_cast<std::uint64_t>(count);
  }
}

void FileSource::read(std::uint64_t begin, std::span<std::byte> piece) {
  if (piece.size() > window_.size()) return read_directly(begin, piece);
  if (begin < window_begin_ || begin + piece.size() > window_begin_ + window_size_) {
    window_size_ = 0;
    const std::size_t size = std::min<std::uint64_t>(window_.size(), size_ - begin);
    read_directly(begin, std::span(window_).first(size));
    window_begin_ = begin;
    window_size_ = size;
  }
  std::memcpy(piece.data(), window_.data() + (begin - window_begin_), piece.size());
}

void MemorySource::read(std::uint64_t begin, std::span<std::byte> piece) {
  std::ranges::copy(bytes_.subspan(begin, piece.size()), piece.begin());
}

std::string_view to_string(Compression compression) {
  constexpr std::array<std::string_view, 4> kNames = {"none", "zstd", "lz4", "bz2"};
  return kNames[static_cast<std::size_t>(compression)];
}

std::optional<Compression> parse_compression(std::string_view text) {
  if (text.empty()) return Compression::none;
  for (const Compression each : {Compression::none, Compression::zstd, Compression::lz4, Compression::bz2}) {
    if (text == to_string(each)) return each;
  }
  return std::nullopt;
}

Decompressed decompress(Compression compression, std::span<const std::byte> bytes, std::size_t most) {
  switch (compression) {
    case Compression::zstd:
      return decompress_with<ZstdDecoder>(bytes, most);
    case Compression::lz4:
      return decompress_with<Lz4Decoder>(bytes, most);
    case Compression::bz2:
      return decompress_with<Bz2Decoder>(bytes, most);
    case Compression::none:
      break;
  }
  const std::span<const std::byte> kept = bytes.first(std::min(bytes.size(), most));
  return {{kept.begin(), kept.end()}, kept.size() == bytes.size()};
}

bool is_zstd(std::span<const std::byte> bytes) {
  constexpr std::array kMagic = {std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F}, std::byte{0xFD}};
  return bytes.size() >= kMagic.size() && std::ranges::equal(bytes.first<kMagic.size()>(), kMagic);
}

std::vector<std::byte> compress_zstd(std::span<const std::byte> bytes) {
  constexpr int kLevel = 1;
  std::vector<std::byte> compressed(ZSTD_compressBound(bytes.size()));
  compressed.resize(ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), kLevel));
  return compressed;
}

bool decompress_zstd_file(const std::filesystem::path& from, const std::filesystem::path& to, std::uint64_t most) try {
  constexpr std::size_t kPiece = 1 << 20;
  FileSource source(from);
  OutputFile output(to, FileContent::other, Durability::unsynced);
  ZstdDecoder decoder;
  std::vector<std::byte> made(kPiece);
  bool is_sound = true, is_end = true;
  std::error_code error;
  const std::uint64_t usable = std::filesystem::space(to.parent_path(), error).available / 10 * 9;
  std::uint64_t written = 0;
  for (std::uint64_t begin = 0; begin < source.size() && is_sound; begin += kPiece) {
    const std::vector<std::byte> piece = read_piece(source, begin, kPiece);
    for (std::span<const std::byte> left = piece; is_sound;) {
      const Step step = decoder.step(left, made);
      left = left.subspan(step.taken);
      written += step.made;
      if (written > most) {
        throw InputError(from.string(), "exceeds " + std::to_string(most >> 20) + " MB when decompressed",
                         "if the bag is intact, decompress it with \"zstd -d\" and give the result");
      }
      if (!error && written > usable) {
        throw InputError(from.string(), "needs more than the free space in " + to.parent_path().string(),
                         "free disk space there, or set TMPDIR to another folder");
      }
      output.append(std::span(made).first(step.made));
      is_sound = step.is_sound;
      is_end = step.is_end;
      if (left.empty() && step.made < made.size()) break;
    }
  }
  output.publish();
  return is_sound && is_end;
} catch (const InputError& error) {
  if (error.place() != to.string()) throw;
  throw InputError(from.string(), "cannot be decompressed into " + to.string() + ": " + error.reason(),
                   "free disk space there, or set TMPDIR to another folder");
}

}  // namespace byre
