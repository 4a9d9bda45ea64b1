#include "io/volume_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/volume_grid.h"

namespace gonio::io {
namespace {

constexpr std::size_t samples_at_once = 1 << 20;

// What `f` makes of a sample of the type.
template <class F>
auto of_voxel_type(VoxelType type, F f) {
  switch (type) {
    case VoxelType::u8: return f(std::uint8_t{});
    case VoxelType::i8: return f(std::int8_t{});
    case VoxelType::u16: return f(std::uint16_t{});
    case VoxelType::i16: return f(std::int16_t{});
    case VoxelType::u32: return f(std::uint32_t{});
    case VoxelType::i32: return f(std::int32_t{});
    case VoxelType::f32: return f(float{});
    case VoxelType::f64: break;
  }
  return f(double{});
}

template <class T, bool swapped>
T sample_at(const char* from) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (swapped) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T, bool swapped>
void decode_all(const char* from, double slope, double intercept, std::span<float> to) {
  if (slope == 1 && intercept == 0) {
    for (std::size_t n = 0; n < to.size(); ++n) to[n] = static_cast<float>(sample_at<T, swapped>(from + n * sizeof(T)));
    return;
  }
  for (std::size_t n = 0; n < to.size(); ++n)
    to[n] = static_cast<float>(slope * static_cast<double>(sample_at<T, swapped>(from + n * sizeof(T))) + intercept);
}

class LinearVolume : public VolumeSource {
 public:
  LinearVolume(VolumeHead head, std::unique_ptr<ByteSource> bytes, bool big_endian)
      : bytes_(std::move(bytes)), swapped_(is_swapped(big_endian)) {
    head_ = std::move(head);
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::size_t sample = bytes_of(head_.type), slice = head_.size[0] * head_.size[1];
    block_.resize(std::min(to.size(), samples_at_once) * sample);
    std::uint64_t at = std::uint64_t{first} * slice * sample;
    for (auto rest = to; !rest.empty();) {
      throw_if_interrupted();
      const auto some = rest.first(std::min(rest.size(), samples_at_once));
      const auto stored = std::span(block_).first(some.size() * sample);
      bytes_->read(at, stored);
      decode_samples(stored, head_.type, swapped_, head_.slope, head_.intercept, some);
      at += stored.size();
      rest = rest.subspan(some.size());
    }
    check_samples(to, head_, first);
  }

 private:
  std::unique_ptr<ByteSource> bytes_;
  bool swapped_;
  std::vector<char> block_;
};

class TextVolume : public VolumeSource {
 public:
  TextVolume(VolumeHead head, const std::filesystem::path& file, std::uint64_t from)
      : file_(file), length_(length_of_file(file) - from) {
    head_ = std::move(head);
    bytes_ = bytes_of_files({{.path = file, .first = from}}, length_);
  }
  void read(std::size_t first, std::size_t count, std::span<float> to) override {
    check_slices(head_, first, count, to);
    const std::uint64_t slice = head_.size[0] * head_.size[1], wanted = slice * first;
    if (wanted < sample_) at_ = block_first_ = sample_ = 0, block_.clear();
    while (sample_ < wanted) next();
    for (float& value : to) value = static_cast<float>(head_.slope * next() + head_.intercept);
    check_samples(to, head_, first);
  }

 private:
  static bool parts(char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); }

  // 0 behind the end, which parts numbers as a blank does.
  char byte_at(std::uint64_t at) {
    if (at >= length_) return 0;
    if (at < block_first_ || at >= block_first_ + block_.size()) {
      block_first_ = at;
      block_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(std::size_t{1} << 16, length_ - at)));
      bytes_->read(at, block_);
    }
    return block_[static_cast<std::size_t>(at - block_first_)];
  }

  double next() {
    std::array<char, 64> word;
    std::size_t n = 0;
    while (at_ < length_ && parts(byte_at(at_))) ++at_;
    for (; at_ < length_ && !parts(byte_at(at_)); ++at_) {
      if (n == word.size()) refuse_word({word.data(), n}, "is longer than any number");
      word[n++] = byte_at(at_);
    }
    if (n == 0)
      refuse_volume(file_.string(), "ends after " + std::to_string(sample_) + " samples where its head promises " +
                                        std::to_string(head_.voxels()));
    double value = 0;
    const char* begin = word.data() + (word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + n, value);
    if (error != std::errc{} || end != word.data() + n) refuse_word({word.data(), n}, "is no number");
    of_voxel_type(head_.type, [&]<class T>(T) {
      if constexpr (std::numeric_limits<T>::is_integer)
        if (!(value >= std::numeric_limits<T>::min() && value <= std::numeric_limits<T>::max()) ||
            value != std::floor(value))
          refuse_word({word.data(), n}, std::string("is no ") + name_of(head_.type));
    });
    ++sample_;
    return value;
  }

  [[noreturn]] void refuse_word(std::string_view word, const std::string& why) const {
    std::string shown(word.substr(0, 24));
    for (char& c : shown)
      if (c < ' ' || c > '~') c = '?';
    const std::uint64_t slice = head_.size[0] * head_.size[1];
    refuse_volume(file_.string() + "#slice " + std::to_string(sample_ / slice),
                  "sample " + std::to_string(sample_ % slice) + ", \"" + shown + "\", " + why);
  }

  std::filesystem::path file_;
  std::uint64_t length_;
  std::unique_ptr<ByteSource> bytes_;
  std::vector<char> block_;
  std::uint64_t block_first_ = 0, at_ = 0, sample_ = 0;
};

}  // namespace

bool is_swapped(bool big_endian) {
  return big_endian != (std::endian::native == std::endian::big);
}

void decode_samples(std::span<const char> bytes, VoxelType type, bool swapped, double slope, double intercept,
                    std::span<float> to) {
  of_voxel_type(type, [&]<class T>(T) {
    if (swapped)
      decode_all<T, true>(bytes.data(), slope, intercept, to);
    else
      decode_all<T, false>(bytes.data(), slope, intercept, to);
  });
}

void check_samples(std::span<const float> values, const VolumeHead& head, std::size_t first) {
  const auto bad = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
  if (bad == values.end()) return;
  const auto n = static_cast<std::size_t>(bad - values.begin()), slice = head.size[0] * head.size[1];
  const std::string file = head.files.empty() ? "volume" : head.files.front().string();
  throw Error(Exit::data, file + "#slice " + std::to_string(first + n / slice),
              "sample (" + std::to_string(n % head.size[0]) + ", " + std::to_string(n % slice / head.size[0]) +
                  ") is " + (std::isnan(*bad) ? "no number" : "beyond a float's largest number"),
              "put a number there, such as air's, before");
}

void check_slices(const VolumeHead& head, std::size_t first, std::size_t count, std::span<float> to) {
  if (first > head.size[2] || count > head.size[2] - first || to.size() != count * head.size[0] * head.size[1])
    throw Error(Exit::internal, head.files.empty() ? "volume" : head.files.front().string(),
                "slices " + std::to_string(first) + " to " + std::to_string(first + count) + " of " +
                    std::to_string(head.size[2]) + " are asked for into " + std::to_string(to.size()) + " floats");
}

std::unique_ptr<VolumeSource> linear_volume(VolumeHead head, std::unique_ptr<ByteSource> bytes, bool big_endian) {
  return std::make_unique<LinearVolume>(std::move(head), std::move(bytes), big_endian);
}

std::unique_ptr<VolumeSource> text_volume(VolumeHead head, const std::filesystem::path& file, std::uint64_t from) {
  const std::uint64_t length = length_of_file(file), own = length > from ? length - from : 0;
  if ((own + 1) / 2 < head.voxels())  // a digit and what parts it from the next
    refuse_volume(file.string(), "has " + std::to_string(own) + " bytes of text, too few for the " +
                                     std::to_string(head.voxels()) + " samples that its head promises");
  return std::make_unique<TextVolume>(std::move(head), file, from);
}

}  // namespace gonio::io
