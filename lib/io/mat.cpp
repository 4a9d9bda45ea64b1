// MATLAB files by libmatio, which is loaded when the first one is read or written: HDF5 and what transports data over
// networks come along, 35 libraries. CMake says which file it is (GONIO_MATIO). Before it sees a file, the outer
// structure of a version 5 file is held against the file's length: libmatio takes what a tag claims for granted.
#include "io/mat.h"

#include <matio.h>

#include <cstdint>
#include <memory>
#include <mutex>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/loaded_library.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t head_bytes = 128, most_numbers = std::size_t{1} << 28, deepest = 16;
constexpr double most_inflation = 1032;  // of deflate: a byte holds at most 1032
const std::string remedy = "copy it again, or save it anew: save FILE ... -v7";
std::mutex one_at_a_time;  // its HDF5 part is not re-entrant

// libmatio's functions by their own declarations.
struct Matio {
  decltype(&Mat_Open) open;
  decltype(&Mat_CreateVer) create;
  decltype(&Mat_Close) close;
  decltype(&Mat_Rewind) rewind;
  decltype(&Mat_VarReadNext) next;
  decltype(&Mat_VarReadNextInfo) next_head;
  decltype(&Mat_VarWrite) write;
  decltype(&Mat_VarCreate) made;
  decltype(&Mat_VarCreateStruct2) made_structure;
  decltype(&Mat_VarFree) free;
  decltype(&Mat_SizeOf) size_of;
  decltype(&Mat_VarGetCell) cell;
  decltype(&Mat_VarGetNumberOfFields) fields;
  decltype(&Mat_VarGetStructFieldnames) names;
  decltype(&Mat_VarGetStructFieldByIndex) member;
  decltype(&Mat_VarSetStructFieldByName) set_member;
};

const Matio& matio() {
  static const Matio loaded = [] {
    Matio all{};
    const auto find = [](auto& function, const char* name) {
      load(function, GONIO_MATIO, name, "install libmatio as it was when this was built");
    };
    find(all.open, "Mat_Open");
    find(all.create, "Mat_CreateVer");
    find(all.close, "Mat_Close");
    find(all.rewind, "Mat_Rewind");
    find(all.next, "Mat_VarReadNext");
    find(all.next_head, "Mat_VarReadNextInfo");
    find(all.write, "Mat_VarWrite");
    find(all.made, "Mat_VarCreate");
    find(all.made_structure, "Mat_VarCreateStruct2");
    find(all.free, "Mat_VarFree");
    find(all.size_of, "Mat_SizeOf");
    find(all.cell, "Mat_VarGetCell");
    find(all.fields, "Mat_VarGetNumberOfFields");
    find(all.names, "Mat_VarGetStructFieldnames");
    find(all.member, "Mat_VarGetStructFieldByIndex");
    find(all.set_member, "Mat_VarSetStructFieldByName");
    return all;
  }();
  return loaded;
}

struct VariableFree {
  void operator()(matvar_t* v) const { matio().free(v); }
};
using Handle = std::unique_ptr<matvar_t, VariableFree>;
struct FileClose {
  void operator()(mat_t* f) const { matio().close(f); }
};
using FileHandle = std::unique_ptr<mat_t, FileClose>;

[[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& hint = remedy) {
  throw Error(Exit::data, place, problem, hint);
}

std::uint32_t word(std::string_view file, std::size_t at, bool swapped) {
  const auto w = stored_at<std::uint32_t>(file, at);
  return swapped ? __builtin_bswap32(w) : w;
}

// Number of top-level variables of a version 5 file; each must be a matrix or a compressed matrix inside the file.
std::size_t count_elements(std::string_view file, const std::string& place) {
  const bool swapped = file[126] == 'M' && file[127] == 'I';
  std::size_t at = head_bytes, count = 0;
  while (at < file.size()) {
    const std::string which = "variable " + std::to_string(count + 1) + " (byte " + std::to_string(at) + ")";
    if (file.size() - at < 8) refuse(place, "ends within the tag of " + which);
    const std::uint32_t type = word(file, at, swapped), bytes = word(file, at + 4, swapped);
    if (type != MAT_T_MATRIX && type != MAT_T_COMPRESSED)
      refuse(place, which + " has type " + std::to_string(type) + ", a variable has 14 or 15");
    if (bytes > file.size() - at - 8)
      refuse(place, which + " claims " + std::to_string(bytes) + " bytes where " +
                        std::to_string(file.size() - at - 8) + " are left: the file is truncated");
    at += 8 + bytes;
    ++count;
  }
  return count;
}

enum class Version { v5, hdf5 };
Version version_of(std::string_view file, const std::string& place) {
  if (file.size() >= 4 && file.substr(0, 4) == "\x89HDF") return Version::hdf5;
  if (file.size() >= head_bytes && file.starts_with("MATLAB 7.3")) return Version::hdf5;
  if (file.size() < head_bytes)
    refuse(place, "has " + std::to_string(file.size()) + " bytes, a MATLAB file has 128 and more");
  const std::string_view order = file.substr(126, 2);
  if (order != "IM" && order != "MI")
    refuse(place, "is no MATLAB file: its bytes 127 and 128 are not \"IM\" or \"MI\"");
  return Version::v5;
}

template <class T>
void append(const matvar_t& v, std::size_t count, std::vector<double>& out) {
  const T* from = static_cast<const T*>(v.data);
  out.assign(from, from + count);
}

void read_numbers(const matvar_t& v, std::size_t count, MatVariable& out, const std::string& place) {
  if (count == 0) return;
  if (v.data == nullptr || v.nbytes < count * matio().size_of(v.data_type))
    refuse(place, "has no data behind its head");
  switch (v.data_type) {
    case MAT_T_DOUBLE: return append<double>(v, count, out.values);
    case MAT_T_SINGLE: return append<float>(v, count, out.values);
    case MAT_T_INT8: return append<std::int8_t>(v, count, out.values);
    case MAT_T_UINT8: return append<std::uint8_t>(v, count, out.values);
    case MAT_T_INT16: return append<std::int16_t>(v, count, out.values);
    case MAT_T_UINT16: return append<std::uint16_t>(v, count, out.values);
    case MAT_T_INT32: return append<std::int32_t>(v, count, out.values);
    case MAT_T_UINT32: return append<std::uint32_t>(v, count, out.values);
    case MAT_T_INT64: return append<std::int64_t>(v, count, out.values);
    case MAT_T_UINT64: return append<std::uint64_t>(v, count, out.values);
    default: refuse(place, "holds numbers of an unknown type");
  }
}

void append_utf8(std::string& text, std::uint32_t c) {
  const auto put = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (c < 0x80) return put(c);
  if (c < 0x800) return put(0xc0 | (c >> 6)), put(0x80 | (c & 0x3f));
  put(0xe0 | (c >> 12)), put(0x80 | ((c >> 6) & 0x3f)), put(0x80 | (c & 0x3f));
}

std::string read_text(const matvar_t& v, std::size_t count) {
  std::string text;
  if (v.data == nullptr) return text;
  const std::size_t width = matio().size_of(v.data_type), there = width == 0 ? 0 : std::min(count, v.nbytes / width);
  for (std::size_t i = 0; i < there; ++i) {
    if (width == 2)
      append_utf8(text, static_cast<const std::uint16_t*>(v.data)[i]);
    else if (v.data_type == MAT_T_UTF8 || v.data_type == MAT_T_UINT8 || v.data_type == MAT_T_INT8)
      text += static_cast<const char*>(v.data)[i];
  }
  return text;
}

MatVariable variable_of(const matvar_t* v, const std::string& place, std::size_t depth);

void read_members(const matvar_t& v, std::size_t count, MatVariable& out, const std::string& place, std::size_t depth) {
  auto* source = const_cast<matvar_t*>(&v);  // libmatio's getters change nothing
  const unsigned fields = matio().fields(source);
  char* const* names = matio().names(source);
  if (fields > 0 && (names == nullptr || v.data == nullptr)) refuse(place, "is a struct without fields' names");
  for (std::size_t i = 0; i < count; ++i) {
    std::map<std::string, MatVariable> element;
    for (unsigned k = 0; k < fields; ++k) {
      const matvar_t* member = matio().member(source, k, i);
      const std::string at = place + (count > 1 ? "(" + std::to_string(i + 1) + ")" : "") + "." + names[k];
      if (member != nullptr) element.emplace(names[k], variable_of(member, at, depth + 1));
    }
    out.elements.push_back(std::move(element));
  }
}

MatVariable variable_of(const matvar_t* v, const std::string& place, std::size_t depth) {
  if (depth > deepest) refuse(place, "is nested more than 16 deep");
  MatVariable out;
  std::size_t count = 1;
  for (int i = 0; i < v->rank; ++i) {
    out.size.push_back(v->dims[i]);
    if (v->dims[i] != 0 && count > most_numbers / v->dims[i]) refuse(place, "claims more than 2^28 numbers");
    count *= v->dims[i];
  }
  if (v->isComplex) refuse(place, "is complex", "save its real part");
  switch (v->class_type) {
    case MAT_C_CHAR:
      out.kind = MatVariable::Kind::text;
      out.text = read_text(*v, count);
      return out;
    case MAT_C_STRUCT:
      out.kind = MatVariable::Kind::structure;
      read_members(*v, count, out, place, depth);
      return out;
    case MAT_C_CELL:
      out.kind = MatVariable::Kind::cells;
      for (std::size_t i = 0; i < count; ++i) {
        const matvar_t* cell = matio().cell(const_cast<matvar_t*>(v), static_cast<int>(i));
        out.cells.emplace_back();
        if (cell == nullptr)
          out.cells.back().size = {0, 0};
        else
          out.cells.back() = variable_of(cell, place + "{" + std::to_string(i + 1) + "}", depth + 1);
      }
      return out;
    case MAT_C_SPARSE: refuse(place, "is sparse", "save it as full(...)");
    case MAT_C_OBJECT:
    case MAT_C_FUNCTION:
    case MAT_C_OPAQUE: refuse(place, "is an object, a function or a table", "save arrays and structs of them");
    default: break;
  }
  out.kind = v->isLogical ? MatVariable::Kind::logical : MatVariable::Kind::numbers;
  read_numbers(*v, count, out, place);
  return out;
}

// What the heads claim, before any data are read.
void check_claims(mat_t* file, std::size_t bytes, const std::string& place) {
  while (const Handle v{matio().next_head(file)}) {
    double count = 1;
    for (int i = 0; i < v->rank; ++i) count *= static_cast<double>(v->dims[i]);
    const std::string at = place + "#" + (v->name == nullptr ? "" : v->name);
    if (v->rank < 2) refuse(at, "has fewer than two dimensions");
    if (count > static_cast<double>(most_numbers) || count > most_inflation * static_cast<double>(bytes))
      refuse(at, "claims " + std::to_string(count) + " numbers, which " + std::to_string(bytes) + " bytes cannot hold");
  }
  matio().rewind(file);
}

}  // namespace

MatFile read_mat(const std::filesystem::path& path) {
  const std::string place = path.string();
  std::size_t bytes = 0, expected = 0;
  {
    const std::string file = read_file(path);
    bytes = file.size();
    if (version_of(file, place) == Version::v5) expected = count_elements(file, place);
  }
  const std::lock_guard lock(one_at_a_time);
  const FileHandle file{matio().open(place.c_str(), MAT_ACC_RDONLY)};
  if (!file) refuse(place, "is no MATLAB file that libmatio can open");
  check_claims(file.get(), bytes, place);
  MatFile out;
  std::size_t found = 0;
  while (const Handle v{matio().next(file.get())}) {
    ++found;
    if (v->name == nullptr || *v->name == 0) continue;  // MATLAB's own bookkeeping of objects
    out[v->name] = variable_of(v.get(), place + "#" + v->name, 0);
  }
  if (found < expected)
    refuse(place, "variable " + std::to_string(found + 1) + " of " + std::to_string(expected) + " is damaged");
  if (out.empty()) refuse(place, "holds no variable");
  return out;
}

namespace {

Handle made(const std::string& name, const MatVariable& v);

// libmatio copies what it is given and changes none of it.
Handle created(const std::string& name, matio_classes kind, matio_types type, std::vector<std::size_t> size,
               const void* data, int options = 0) {
  return Handle{matio().made(name.c_str(), kind, type, static_cast<int>(size.size()), size.data(),
                             const_cast<void*>(data), options)};
}

Handle made_structure(const std::string& name, const MatVariable& v) {
  std::vector<const char*> names;
  if (!v.elements.empty())
    for (const auto& [key, member] : v.elements.front()) names.push_back(key.c_str());
  names.push_back(nullptr);
  Handle out{matio().made_structure(name.c_str(), static_cast<int>(v.size.size()), v.size.data(), names.data())};
  if (!out) return out;
  for (std::size_t i = 0; i < v.elements.size(); ++i)
    for (const auto& [key, member] : v.elements[i])
      matio().set_member(out.get(), key.c_str(), i, made(key, member).release());
  return out;
}

Handle made(const std::string& name, const MatVariable& v) {
  switch (v.kind) {
    case MatVariable::Kind::structure: return made_structure(name, v);
    case MatVariable::Kind::text:
      return created(name, MAT_C_CHAR, MAT_T_UTF8, {v.text.empty() ? std::size_t{0} : 1, v.text.size()},
                     v.text.c_str());
    case MatVariable::Kind::logical: {
      const std::vector<std::uint8_t> bytes(v.values.begin(), v.values.end());
      return created(name, MAT_C_UINT8, MAT_T_UINT8, v.size, bytes.data(), MAT_F_LOGICAL);
    }
    case MatVariable::Kind::cells: {
      std::vector<matvar_t*> cells;
      for (const MatVariable& cell : v.cells) cells.push_back(made("", cell).release());
      return created(name, MAT_C_CELL, MAT_T_CELL, v.size, cells.data());
    }
    case MatVariable::Kind::numbers: break;
  }
  return created(name, MAT_C_DOUBLE, MAT_T_DOUBLE, v.size, v.values.data());
}

void check_size(const std::string& name, const MatVariable& v) {
  std::size_t count = 1;
  for (const std::size_t n : v.size) count *= n;
  const bool numbers = v.kind == MatVariable::Kind::numbers || v.kind == MatVariable::Kind::logical;
  const bool right = v.kind == MatVariable::Kind::text ||
                     (v.size.size() >= 2 && count == (numbers                                  ? v.values.size()
                                                      : v.kind == MatVariable::Kind::structure ? v.elements.size()
                                                                                               : v.cells.size()));
  if (!right) throw Error(Exit::internal, name, "has another size than it says");
}

}  // namespace

void write_mat(const MatFile& variables, const std::filesystem::path& path) {
  for (const auto& [name, v] : variables) check_size(name, v);
  write_file_through(path, [&](const std::filesystem::path& temporary) {
    const std::lock_guard lock(one_at_a_time);
    const FileHandle file{matio().create(temporary.c_str(), "MATLAB 5.0 MAT-file, written by gonio", MAT_FT_MAT5)};
    if (!file) throw Error(Exit::cannot_create, path.string(), "cannot be created");
    for (const auto& [name, v] : variables) {
      const Handle out = made(name, v);
      if (!out || matio().write(file.get(), out.get(), MAT_COMPRESSION_ZLIB) != 0)
        throw Error(Exit::io, path.string(), "variable " + name + " could not be written");
    }
  });
}

}  // namespace gonio::io
