// See variables.h.
#include "nrsfm/variables.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/npz.h"

namespace gonio::nrsfm {
namespace {

using io::MatVariable;
using Kind = MatVariable::Kind;

[[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& remedy = {}) {
  throw Error(Exit::data, place, problem, remedy);
}

// C order to MATLAB's: the last index becomes the slowest.
MatVariable of_numpy(const io::NpyArray& a) {
  MatVariable v;
  if (a.values.empty() && !a.text.empty()) return variable_of(a.text);
  v.size = a.size;
  if (v.size.empty()) v.size = {1};
  if (v.size.size() == 1) v.size.insert(v.size.begin(), 1);  // a vector is a row
  v.values.resize(a.values.size());
  std::vector<std::size_t> at(v.size.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    std::size_t rest = i, index = 0;
    for (std::size_t k = v.size.size(); k-- > 0;) at[k] = rest % v.size[k], rest /= v.size[k];
    for (std::size_t k = v.size.size(); k-- > 0;) index = index * v.size[k] + at[k];
    v.values[index] = a.values[i];
  }
  return v;
}

bool is_numbers(const MatVariable& v) {
  return v.kind == Kind::numbers || v.kind == Kind::logical;
}

// The matrices of a list or of a struct's only (or only numeric) field, one a frame.
std::vector<const MatVariable*> by_frames(const MatVariable& v) {
  std::vector<const MatVariable*> frames;
  for (const MatVariable& cell : v.cells) frames.push_back(&cell);
  for (const auto& element : v.elements)
    for (const auto& [key, member] : element)
      if (is_numbers(member)) {
        frames.push_back(&member);
        break;
      }
  return frames;
}

// Names in which numbers count as numbers: frame_2 before frame_10.
bool before(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    if (!digit(a[i]) || !digit(b[k])) {
      if (a[i] != b[k]) return a[i] < b[k];
      ++i, ++k;
      continue;
    }
    while (i < a.size() && a[i] == '0') ++i;
    while (k < b.size() && b[k] == '0') ++k;
    std::size_t m = 0, n = 0;
    while (i + m < a.size() && digit(a[i + m])) ++m;
    while (k + n < b.size() && digit(b[k + n])) ++n;
    if (m != n) return m < n;
    if (const int order = a.compare(i, m, b, k, n); order != 0) return order < 0;
    i += m, k += n;
  }
  return a.size() - i < b.size() - k;
}

bool matches(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*')
    return matches(pattern.substr(1), name) || (!name.empty() && matches(pattern, name.substr(1)));
  return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
         matches(pattern.substr(1), name.substr(1));
}

// Arrays of three dimensions: MATLAB's habit rows x points x frames, NumPy's frames x rows x points and frames x points
// x rows. The axis of length `rows` tells which, the first one where several have it.
Eigen::MatrixXd of_cube(const MatVariable& v, std::size_t rows, const std::string& where) {
  const auto axis = static_cast<std::size_t>(std::ranges::find(v.size, rows) - v.size.begin());
  if (axis == 3)
    refuse(where, "is " + size_text(v.size) + " without an axis of " + std::to_string(rows) + " coordinates",
           "arrays of three dimensions are " + std::to_string(rows) + " x points x frames, frames x " +
               std::to_string(rows) + " x points or frames x points x " + std::to_string(rows));
  const std::size_t frame_axis = axis == 0 ? 2 : 0, point_axis = 3 - axis - frame_axis;
  const std::size_t stride[] = {1, v.size[0], v.size[0] * v.size[1]};
  const std::size_t frames = v.size[frame_axis], points = v.size[point_axis];
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows * frames), static_cast<Eigen::Index>(points));
  for (std::size_t p = 0; p < points; ++p)
    for (std::size_t f = 0; f < frames; ++f)
      for (std::size_t r = 0; r < rows; ++r)
        out(static_cast<Eigen::Index>(rows * f + r), static_cast<Eigen::Index>(p)) =
            v.values[f * stride[frame_axis] + p * stride[point_axis] + r * stride[axis]];
  return out;
}

}  // namespace

std::string size_text(const std::vector<std::size_t>& size) {
  std::string text;
  for (const std::size_t n : size) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text;
}

Eigen::MatrixXd matrix_of(const MatVariable& v, const std::string& place) {
  if (!is_numbers(v)) refuse(place, "is no array of numbers");
  if (v.size.size() != 2) refuse(place, "is " + size_text(v.size) + ", a matrix is needed");
  return Eigen::Map<const Eigen::MatrixXd>(v.values.data(), static_cast<Eigen::Index>(v.size[0]),
                                           static_cast<Eigen::Index>(v.size[1]));
}

MatVariable variable_of(const Eigen::MatrixXd& m) {
  MatVariable v;
  v.size = {static_cast<std::size_t>(m.rows()), static_cast<std::size_t>(m.cols())};
  v.values.assign(m.data(), m.data() + m.size());
  return v;
}

MatVariable variable_of(const std::string& text) {
  MatVariable v;
  v.kind = Kind::text;
  v.size = {1, text.size()};
  v.text = text;
  return v;
}

Variables::Variables(const std::filesystem::path& file) : place_(file.string()) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  if (extension == ".mat") {
    variables_ = io::read_mat(file);
  } else if (extension == ".npz") {
    for (const auto& [name, array] : io::read_npz(file)) variables_[name] = of_numpy(array);
  } else if (extension == ".npy") {  // one array without a name: shapes, by the name that truth and answers share
    io::NpyArray array;
    if (!io::parse_npy(read_file(file), place_, array))
      refuse(place_, "holds no numbers", "save an array of floats");
    variables_["S"] = of_numpy(array);
  } else {
    refuse(place_, "is neither .mat nor .npz nor .npy", "name the file by what it is");
  }
}

const MatVariable* Variables::find(const std::string& name) const {
  const auto found = variables_.find(name);
  return found == variables_.end() ? nullptr : &found->second;
}

std::string Variables::list() const {
  std::string names;
  for (const auto& [name, v] : variables_) names += (names.empty() ? "" : ", ") + name;
  return names.size() > 100 ? names.substr(0, 97) + "..." : names;
}

const MatVariable& Variables::at(const std::string& name) const {
  const MatVariable* v = find(name);
  if (v == nullptr) refuse(place_, "has no variable " + name, "it has " + list());
  return *v;
}

std::string Variables::named(const std::string& given, std::initializer_list<const char*> usual) const {
  if (!given.empty()) return at(given), given;
  for (const char* name : usual)
    if (find(name) != nullptr) return name;
  return {};
}

Eigen::MatrixXd Variables::rows_by_frame(const std::string& name, Eigen::Index rows, bool* by_frame) const {
  const MatVariable& v = at(name);
  const std::string where = place(name);
  const auto wanted = static_cast<std::size_t>(rows);
  if (by_frame != nullptr) *by_frame = true;
  if (!is_numbers(v)) {
    const std::vector<const MatVariable*> frames = by_frames(v);
    if (frames.empty()) refuse(where, "holds no numbers");
    Eigen::MatrixXd out;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const std::string at = where + "(" + std::to_string(f + 1) + ")";
      const Eigen::MatrixXd m = matrix_of(*frames[f], at);
      if (m.rows() < rows || m.rows() > 3 || m.cols() == 0 || (f > 0 && m.cols() != out.cols()))
        refuse(at, "is " + size_text(frames[f]->size) + " where " + std::to_string(rows) + " x " +
                       (f > 0 ? std::to_string(out.cols()) : std::string("P")) + " is needed");
      if (f == 0) out.resize(rows * static_cast<Eigen::Index>(frames.size()), m.cols());
      out.middleRows(static_cast<Eigen::Index>(f) * rows, rows) =
          m.rows() > rows ? Eigen::MatrixXd(m.topRows(rows).array().rowwise() / m.row(rows).array()) : m;
    }
    return out;
  }
  if (v.size.size() == 3) return of_cube(v, wanted, where);
  if (by_frame != nullptr) *by_frame = false;
  const Eigen::MatrixXd m = matrix_of(v, where);
  if (m.rows() == 0 || m.cols() == 0 || m.rows() % rows != 0)
    refuse(where, "is " + size_text(v.size) + ", its rows are to be " + std::to_string(rows) + " for each frame");
  return m;
}

Shapes Variables::shapes(const std::string& name, bool* by_frame) const {
  return rows_by_frame(name, 3, by_frame);
}
Tracks Variables::tracks(const std::string& name) const {
  return rows_by_frame(name, 2, nullptr);
}
Eigen::MatrixXd Variables::matrix(const std::string& name) const {
  return matrix_of(at(name), place(name));
}

double Variables::number(const std::string& name) const {
  const Eigen::MatrixXd m = matrix(name);
  if (m.size() != 1 || !std::isfinite(m(0, 0))) refuse(place(name), "is not one finite number");
  return m(0, 0);
}

std::string Variables::text(const std::string& name) const {
  const MatVariable& v = at(name);
  if (v.kind != Kind::text) refuse(place(name), "is no text");
  return v.text;
}

Factors Variables::factors(const std::string& name) const {
  const MatVariable& v = at(name);
  Factors out;
  if (v.kind != Kind::structure || v.elements.size() != 1) refuse(place(name), "is no struct of texts");
  for (const auto& [factor, level] : v.elements.front()) {
    if (level.kind != Kind::text) refuse(place(name) + "." + factor, "is no text", "a level is a word");
    out[factor] = level.text;
  }
  return out;
}

std::vector<std::filesystem::path> files_in_order(const std::filesystem::path& pattern, const std::string& extension) {
  namespace fs = std::filesystem;
  const bool folder = fs::is_directory(pattern);
  const fs::path parent = folder ? pattern : pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  const std::string wanted = folder ? "*" + extension : pattern.filename().string();
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator entry(parent, failed), end; !failed && entry != end; entry.increment(failed))
    if (matches(wanted, entry->path().filename().string())) files.push_back(entry->path());
  if (failed || files.empty())
    throw Error(Exit::no_input, pattern.string(), "names no " + extension + " file",
                "give a folder or a pattern like frame_*" + extension);
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    const std::string x = a.filename().string(), y = b.filename().string();
    return before(x, y) || (!before(y, x) && x < y);
  });
  return files;
}

}  // namespace gonio::nrsfm
