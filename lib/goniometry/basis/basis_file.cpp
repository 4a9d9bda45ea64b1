// A basis as a file. Little-endian: the 16 bytes of `head`; int32 version; int32 bins[3]; int32 materials, samples,
// components; the description and each material's name, an int32 of their length before them; int32 material of each
// sample; floats log_reference, mean, rest (one per cell), q and, where classes hold several materials, squares of rest
// by classes (cell by cell); doubles scores (sample by sample) and
// singular values; last 64 bytes: SHA-256 of all before, in hexadecimal digits.
#include <bit>
#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "goniometry/basis/basis.h"
#include "io/little_endian.h"

namespace gonio::goniometry {
namespace {

constexpr std::string_view head = "gonio BRDF basis";
constexpr std::int32_t version = 2;
constexpr std::size_t digest = 64;
constexpr std::int32_t most_materials = 100'000, most_text = 4096;

class Writer {
 public:
  template <class T>
  void number(T value) {
    bytes.resize(bytes.size() + sizeof(T));
    io::store_at(bytes, bytes.size() - sizeof(T), value);
  }
  void text(const std::string& words) {
    number(static_cast<std::int32_t>(words.size()));
    bytes += words;
  }
  template <class T>
  void numbers(const std::vector<T>& values) {
    if constexpr (std::endian::native == std::endian::little)
      bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    else
      for (const T value : values) number(value);
  }
  std::string bytes;
};

class Reader {
 public:
  Reader(std::string_view bytes, std::string place) : bytes_(bytes), place_(std::move(place)) {}
  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(Exit::data, place_, problem, "make the basis again from its tables");
  }
  void need(std::size_t count) const {
    if (count > bytes_.size() - at_) refuse("ends after " + std::to_string(bytes_.size()) + " bytes, in mid-basis");
  }
  std::int32_t number(std::int32_t lowest, std::int32_t highest, const char* what) {
    need(sizeof(std::int32_t));
    const auto value = io::stored_at<std::int32_t>(bytes_, at_);
    at_ += sizeof(std::int32_t);
    if (value < lowest || value > highest)
      refuse("claims " + std::to_string(value) + " " + what + ", between " + std::to_string(lowest) + " and " +
             std::to_string(highest) + " are possible");
    return value;
  }
  std::size_t count(std::int32_t lowest, std::int32_t highest, const char* what) {
    return static_cast<std::size_t>(number(lowest, highest, what));
  }
  std::string text() {
    const std::size_t length = count(0, most_text, "letters of a name");
    need(length);
    at_ += length;
    return std::string(bytes_.substr(at_ - length, length));
  }
  template <class T>
  std::vector<T> numbers(std::size_t many) {
    need(many * sizeof(T));
    std::vector<T> values(many);
    if constexpr (std::endian::native == std::endian::little)
      std::memcpy(values.data(), bytes_.data() + at_, many * sizeof(T));
    else
      for (std::size_t i = 0; i < many; ++i) values[i] = io::stored_at<T>(bytes_, at_ + i * sizeof(T));
    at_ += many * sizeof(T);
    return values;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::string_view bytes_;
  std::string place_;
  std::size_t at_ = head.size();
};

}  // namespace

void Basis::save(const std::filesystem::path& file) const {
  Writer w;
  w.bytes = head;
  w.number(version);
  for (const std::size_t bins : cells_->bins()) w.number(static_cast<std::int32_t>(bins));
  for (const std::size_t count : {names_.size(), samples(), components_}) w.number(static_cast<std::int32_t>(count));
  w.text(description_);
  for (const std::string& name : names_) w.text(name);
  for (const std::uint32_t material : material_of_) w.number(static_cast<std::int32_t>(material));
  for (const auto* values : {&log_reference_, &mean_, &rest_, &q_, &class_rest_}) w.numbers(*values);
  w.numbers(scores_);
  w.numbers(singular_);
  w.bytes += sha256(w.bytes);
  write_file(file, w.bytes);
}

Basis Basis::load(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  const std::string_view all(bytes);
  Reader r(all.substr(0, bytes.size() > digest ? bytes.size() - digest : 0), file.string());
  if (!all.starts_with(head)) r.refuse("is no saved basis: it does not begin with \"" + std::string(head) + "\"");
  if (bytes.size() < head.size() + digest) r.refuse("ends within its head");
  if (const auto found = r.number(0, 1'000'000, "as its version"); found != version)
    r.refuse("has version " + std::to_string(found) + ", this program reads " + std::to_string(version));
  if (sha256(all.substr(0, bytes.size() - digest)) != all.substr(bytes.size() - digest))
    r.refuse("is damaged: its checksum does not fit");
  Basis basis;
  Bins bins{};
  for (std::size_t& b : bins) b = r.count(2, 4096, "bins");
  const std::size_t materials = r.count(3, most_materials, "materials"),
                    samples = r.count(3, 3 * most_materials, "samples"), k = r.count(1, most_materials, "components");
  basis.components_ = k;
  basis.description_ = r.text();
  for (std::size_t m = 0; m < materials; ++m) basis.names_.push_back(r.text());
  basis.classify();
  for (std::size_t s = 0; s < samples; ++s)
    basis.material_of_.push_back(
        static_cast<std::uint32_t>(r.number(0, static_cast<std::int32_t>(materials) - 1, "as a sample's material")));
  if (bins[0] * bins[1] * bins[2] / 8 > r.left()) r.refuse("is too short for its bins");
  const auto cells = std::make_shared<const Cells>(bins);
  const std::size_t count = cells->count();
  basis.cells_ = cells;
  for (auto* values : {&basis.log_reference_, &basis.mean_, &basis.rest_}) *values = r.numbers<float>(count);
  basis.q_ = r.numbers<float>(count * k);
  if (basis.classes_ < materials) basis.class_rest_ = r.numbers<float>(count * basis.classes_);
  basis.scores_ = r.numbers<double>(samples * k);
  basis.singular_ = r.numbers<double>(samples);
  if (r.left() != 0) r.refuse("has " + std::to_string(r.left()) + " bytes after its end");
  return basis;
}

}  // namespace gonio::goniometry
