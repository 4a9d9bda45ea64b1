#include "io/slice_files.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/error.h"
#include "io/volume_bytes.h"
#include "io/volume_grid.h"
#include "io/volume_header.h"
#include "io/volume_picture.h"

namespace gonio::io {
namespace {

// The first differing number of two names orders them, "s9" before "s10"; else their letters.
bool in_order(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto end_of = [&](const std::string& text, std::size_t at) {
      while (at < text.size() && is_digit(text[at])) ++at;
      return at;
    };
    while (i + 1 < a.size() && a[i] == '0' && is_digit(a[i + 1])) ++i;
    while (j + 1 < b.size() && b[j] == '0' && is_digit(b[j + 1])) ++j;
    const std::string m = a.substr(i, end_of(a, i) - i), n = b.substr(j, end_of(b, j) - j);
    if (m.size() != n.size()) return m.size() < n.size();
    if (m != n) return m < n;
    i += m.size(), j += n.size();
  }
  return a.size() - i < b.size() - j;
}

// The number that stands last in a name.
std::optional<std::int64_t> number_in(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const auto last = name.find_last_of("0123456789");
  if (last == std::string::npos) return {};
  const auto before = name.find_last_not_of("0123456789", last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return integer_of(std::string_view(name).substr(first, last + 1 - first));
}

}  // namespace

std::vector<std::filesystem::path> slice_pictures(const std::filesystem::path& folder) {
  std::map<bool, std::vector<std::filesystem::path>> found;  // TIFF or not
  std::error_code failure;
  for (std::filesystem::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code ignored;
    if (at->path().filename().string().starts_with('.') || !at->is_regular_file(ignored)) continue;
    const std::string beginning = beginning_of_file(at->path(), 32);
    if (is_picture(beginning)) found[is_tiff(beginning)].push_back(at->path());
  }
  if (failure) throw Error(Exit::no_input, folder.string(), failure.message(), "check its permissions");
  if (found.size() > 1)
    refuse_volume(folder.string(),
                  "holds TIFFs (" + found[true][0].filename().string() + ") and other pictures (" +
                      found[false][0].filename().string() + ")",
                  "leave in it what are slices of one volume");
  auto files = found.empty() ? std::vector<std::filesystem::path>() : std::move(found.begin()->second);
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return in_order(a.filename().string(), b.filename().string()); });
  return files;
}

void check_slice_numbers(const std::vector<std::filesystem::path>& files, const std::string& place) {
  for (std::size_t n = 2; n < files.size(); ++n) {
    const auto a = number_in(files[n - 2]), b = number_in(files[n - 1]), c = number_in(files[n]);
    if (!a || !b || !c || *b - *a == *c - *b) continue;
    const bool later = std::abs(*c - *b) > std::abs(*b - *a);
    refuse_volume(place,
                  "has no slice between " + files[later ? n - 1 : n - 2].filename().string() + " and " +
                      files[later ? n : n - 1].filename().string() + ", where others are numbered in steps of " +
                      std::to_string(std::min(std::abs(*c - *b), std::abs(*b - *a))),
                  "add the missing slices, or number them without a gap");
  }
}

}  // namespace gonio::io
