// Reading and printing of the whole document. A section that a program did not change is written as it was read: what
// to_value() prints for an entry is compared with what it would print for the entry as read, and where the two agree
// the original stands.
#include "manifest/document.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "manifest/relief_tables.h"
#include "manifest/section_tables.h"
#include "manifest/units.h"

namespace gonio::manifest {
namespace {

namespace fs = std::filesystem;

// Calls visit(key, section) for every typed section, in the order in which they are printed.
template <class D, class Visit>
void for_each_section(D& d, const Visit& visit) {
  visit("files", d.files);
  visit("frames", d.frames);
  visit("boards", d.boards);
  visit("cameras", d.cameras);
  visit("rigs", d.rigs);
  visit("robots", d.robots);
  visit("images", d.images);
  visit("meshes", d.meshes);
  visit("surfaces", d.surfaces);
  visit("lights", d.lights);
  visit("objects", d.objects);
  visit("tables", d.tables);
  visit("mechanisms", d.mechanisms);
  visit("renderings", d.renderings);
  visit("comparisons", d.comparisons);
  visit("mountings", d.mountings);
  visit("light_positions", d.light_positions);
  visit("acceptance", d.acceptance);
  visit("goniometer", d.goniometer);
  visit("surface_fits", d.surface_fits);
  visit("patterns", d.patterns);
  visit("contrasts", d.contrasts);
  visit("explanations", d.explanations);
}

template <class T>
void read_section(std::map<std::string, T>& section, const Value& v, const std::string& place) {
  section = Codec<std::map<std::string, T>>::read(v, place);
}
template <class T>
void read_section(std::vector<T>& section, const Value& v, const std::string& place) {
  section = Codec<std::vector<T>>::read(v, place);
}

// What is written where an entry was read: `before` is what the entry as read would print, `written` what it prints
// now. Members that agree stand as they were read, digit for digit, and x-* keys stay, at every level.
Value merged(Value written, const Value* before, const Value& original) {
  if (before != nullptr && written == *before) return original;
  if (!written.is_object() || !original.is_object()) return written;
  Value out = Value::object();
  for (const auto& [key, member] : original.as_object()) {
    if (key.starts_with("x-"))
      out[key] = member;
    else if (const Value* now = written.find(key))
      out[key] = merged(*now, before == nullptr ? nullptr : before->find(key), member);
  }
  for (auto& [key, member] : written.as_object())
    if (out.find(key) == nullptr) out[key] = std::move(member);
  return out;
}

template <class T>
Value write_entry(const T& entry, const Value* original) {
  if (original == nullptr) return Codec<T>::write(entry);
  const Value before = Codec<T>::write(Codec<T>::read(*original, ""));
  return merged(Codec<T>::write(entry), &before, *original);
}

template <class T>
Value write_section(const std::map<std::string, T>& section, const Value* original) {
  Value out;
  if (original != nullptr && original->is_object()) {
    out = Value::object();
    for (const auto& [key, member] : original->as_object()) {  // what was there keeps its place
      if (key.starts_with("x-"))
        out[key] = member;
      else if (const auto found = section.find(key); found != section.end())
        out[key] = write_entry(found->second, &member);
    }
  }
  for (const auto& [key, entry] : section)
    if (out.find(key) == nullptr) out[key] = write_entry(entry, nullptr);
  return out;
}

template <class T>
Value write_section(const std::vector<T>& section, const Value* original) {
  if (section.empty() && original == nullptr) return {};
  const auto id_of = [](const Value& v) -> const Value* {
    return v.find("id") != nullptr ? v.find("id") : v.find("image");
  };
  Value out = Value::array();
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Value written = Codec<T>::write(section[i]);
    const Value* before = nullptr;
    if (original != nullptr && original->is_array()) {
      const auto& entries = original->as_array();
      if (i < entries.size() &&
          (id_of(written) == nullptr || (id_of(entries[i]) != nullptr && *id_of(entries[i]) == *id_of(written))))
        before = &entries[i];
      for (std::size_t k = 0; before == nullptr && id_of(written) != nullptr && k < entries.size(); ++k)
        if (id_of(entries[k]) != nullptr && *id_of(entries[k]) == *id_of(written)) before = &entries[k];
    }
    out.push_back(write_entry(section[i], before));
  }
  return out;
}

// --- references between sections ---

template <class T>
void must_exist(const std::map<std::string, T>& section, const std::string& section_name, const std::string& key,
                const std::string& where) {
  if (key.empty() || section.contains(key)) return;
  std::string names;
  for (const auto& [name, entry] : section) names += (names.empty() ? "" : ", ") + name;
  throw Error(Exit::data, where, "names \"" + key + "\", which is not in " + section_name,
              names.empty() ? "that section is empty"
                            : "there is " + (names.size() > 80 ? names.substr(0, 77) + "..." : names));
}

template <class T>
void unique_ids(const std::vector<T>& section, const std::string& place) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < section.size(); ++i)
    if (!seen.insert(section[i].id).second)
      throw Error(Exit::data, item(place, i) + "/id", "\"" + section[i].id + "\" stands twice",
                  "give every entry its own id");
}

void check_images(const Document& d) {
  unique_ids(d.images, place(d, "/images"));
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const ImageEntry& image = d.images[i];
    const std::string at = place(d, "/images/" + std::to_string(i));
    must_exist(d.files, "files", image.file, at + "/file");
    must_exist(d.files, "files", image.mask, at + "/mask");
    must_exist(d.cameras, "cameras", image.camera, at + "/camera");
    must_exist(d.boards, "boards", image.board, at + "/board");
    for (std::size_t k = 0; k < image.boards.size(); ++k)
      must_exist(d.boards, "boards", image.boards[k].board, at + "/boards/" + std::to_string(k) + "/board");
    must_exist(d.robots, "robots", image.robot, at + "/robot");
    for (const auto& light : image.light) must_exist(d.lights, "lights", light, at + "/light");
  }
}

void check_table(const Table& table, const std::string& at) {
  if (!table.file.empty() && !table.rows.is_null())
    throw Error(Exit::data, at, "has both \"file\" and \"rows\"", "keep one of the two");
  std::vector<std::string> names;
  for (const auto& [name, unit] : table.columns) {
    check_column_unit(name, unit, at + "/columns/" + name);
    names.push_back(name);
  }
  for (const auto& name : table.observed)
    if (std::ranges::find(names, name) == names.end())
      throw Error(Exit::data, at + "/observed", "names column \"" + name + "\", which is not in columns",
                  remedy_for(name, names));
  if (table.rows.is_null()) return;
  expect_array(table.rows, at + "/rows");
  for (std::size_t i = 0; i < table.rows.as_array().size(); ++i) {
    const Value& row = table.rows.as_array()[i];
    if (!row.is_array() || row.as_array().size() != names.size())
      throw Error(Exit::data, item(at + "/rows", i), "is no row of " + std::to_string(names.size()) + " entries",
                  "give one for each column");
  }
}

void check_goniometry(const Document& d) {
  const auto images_exist = [&d](const std::vector<std::string>& ids, const std::string& at) {
    for (const std::string& id : ids)
      if (std::ranges::find(d.images, id, &ImageEntry::id) == d.images.end())
        throw Error(Exit::data, at + "/images", "names \"" + id + "\", which is not in images");
  };
  for (const auto& [name, patch] : d.goniometer) {
    const std::string at = place(d, "/goniometer/" + name);
    must_exist(d.goniometer, "goniometer", patch.tile, at + "/tile");
    must_exist(d.surfaces, "surfaces", patch.surface, at + "/surface");
    if (patch.polygon_m.empty() == !patch.radius_m)
      throw Error(Exit::data, at, "needs exactly one of \"polygon_m\", \"radius_m\"");
    images_exist(patch.images, at);
  }
  for (const auto& [name, fit] : d.surface_fits)
    for (const auto& [what, file] : fit.files)
      must_exist(d.files, "files", file, place(d, "/surface_fits/" + name + "/files/" + what));
  for (const auto& [name, pattern] : d.patterns) {
    const std::string at = place(d, "/patterns/" + name);
    must_exist(d.files, "files", pattern.file, at + "/file");
    must_exist(d.tables, "tables", pattern.corners, at + "/corners");
    for (std::size_t i = 0; i < pattern.placements.size(); ++i)
      images_exist(pattern.placements[i].images, at + "/placements/" + std::to_string(i));
  }
}

void check_reliefs(const Document& d) {
  const ReliefSections sections = read_reliefs(d);
  for (const auto& [name, relief] : sections.reliefs) {
    const std::string at = place(d, "/reliefs/" + name);
    must_exist(d.files, "files", relief.file, at + "/file");
    must_exist(d.tables, "tables", relief.table, at + "/table");
    must_exist(d.surfaces, "surfaces", relief.surface, at + "/surface");
    if (!relief.step_m.empty() && relief.step_m.size() != 2)
      throw Error(Exit::data, at + "/step_m", "has " + std::to_string(relief.step_m.size()) + " numbers",
                  "give two lengths [x, y]");
    for (std::size_t i = 0; i < relief.lobes.size(); ++i)
      must_exist(d.files, "files", relief.lobes[i].picture, at + "/lobes/" + std::to_string(i) + "/picture");
  }
  for (const auto& [name, ground] : sections.ground_noises) {
    const std::string at = place(d, "/ground_noises/" + name);
    for (std::size_t i = 0; i < ground.reliefs.size(); ++i)
      must_exist(sections.reliefs, "reliefs", ground.reliefs[i], at + "/reliefs/" + std::to_string(i));
    must_exist(sections.reliefs, "reliefs", ground.example, at + "/example");
  }
}

void check_references(const Document& d) {
  check_images(d);
  check_goniometry(d);
  check_reliefs(d);
  unique_ids(d.objects, place(d, "/objects"));
  for (std::size_t i = 0; i < d.objects.size(); ++i) {
    const std::string at = place(d, "/objects/" + std::to_string(i));
    must_exist(d.meshes, "meshes", d.objects[i].mesh, at + "/mesh");
    must_exist(d.surfaces, "surfaces", d.objects[i].surface, at + "/surface");
  }
  for (const auto& [name, mesh] : d.meshes) {
    const std::string at = place(d, "/meshes/" + name);
    must_exist(d.files, "files", mesh.file, at + "/file");
    if (!mesh.file.empty() + mesh.sphere_radius_m.has_value() + mesh.plane_size_m.has_value() != 1)
      throw Error(Exit::data, at, "needs exactly one of \"file\", \"sphere\", \"plane\"");
  }
  for (const auto& [name, surface] : d.surfaces) {
    const std::string at = place(d, "/surfaces/" + name);
    for (const auto& [parameter, file] : surface.textures)
      must_exist(d.files, "files", file, at + "/textures/" + parameter);
    for (const auto& [parameter, file] : surface.spectra)
      must_exist(d.files, "files", file, at + "/spectra/" + parameter);
    must_exist(d.files, "files", surface.file, at + "/file");
    must_exist(d.surfaces, "surfaces", surface.base, at + "/base");
  }
  for (const auto& [name, light] : d.lights)
    must_exist(d.files, "files", light.file, place(d, "/lights/" + name + "/file"));
  for (const auto& [name, table] : d.tables) {
    const std::string at = place(d, "/tables/" + name);
    must_exist(d.files, "files", table.file, at + "/file");
    must_exist(d.cameras, "cameras", table.camera, at + "/camera");
    must_exist(d.boards, "boards", table.board, at + "/board");
    check_table(table, at);
  }
  for (const auto& [name, rig] : d.rigs)
    for (std::size_t i = 0; i < rig.cameras.size(); ++i)
      must_exist(d.cameras, "cameras", rig.cameras[i].camera,
                 place(d, "/rigs/" + name + "/cameras/" + std::to_string(i) + "/camera"));
  for (const auto& [name, robot] : d.robots)
    must_exist(d.files, "files", robot.calibration, place(d, "/robots/" + name + "/calibration"));
  unique_ids(d.light_positions, place(d, "/light_positions"));
  for (std::size_t i = 0; i < d.renderings.size(); ++i)
    must_exist(d.files, "files", d.renderings[i].file, place(d, "/renderings/" + std::to_string(i) + "/file"));
}

const std::vector<std::string>& section_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out{"gonio", "provenance", "reliefs", "ground_noises"};
    Document d;
    for_each_section(d, [&out](const char* key, auto&) { out.emplace_back(key); });
    return out;
  }();
  return names;
}

}  // namespace

std::string place(const Document& document, const std::string& pointer) {
  return document.name + "#" + pointer;
}

ReliefSections read_reliefs(const Document& d) {
  ReliefSections sections;
  if (const Value* v = d.original.find("reliefs")) read_section(sections.reliefs, *v, place(d, "/reliefs"));
  if (const Value* v = d.original.find("ground_noises"))
    read_section(sections.ground_noises, *v, place(d, "/ground_noises"));
  return sections;
}

void write_reliefs(Document& d, const ReliefSections& sections) {
  const auto put = [&d](const char* key, const auto& section) {
    Value v = write_section(section, d.original.find(key));
    if (!v.is_null()) d.original[key] = std::move(v);
  };
  put("reliefs", sections.reliefs), put("ground_noises", sections.ground_noises);
}

Document parse_document(std::string_view text, const std::string& name, const fs::path& folder,
                        const ReadOptions& options) {
  Document d;
  d.name = name;
  d.folder = folder.empty() ? fs::path(".") : folder;
  d.allow_outside = options.allow_outside;
  d.original = parse_json(text, name);
  expect_object(d.original, name);
  const Value* version = d.original.find("gonio");
  if (version == nullptr)
    throw Error(Exit::data, name + "#", "is not a gonio manifest: the key \"gonio\" is missing",
                "a manifest starts with {\"gonio\": 1");
  if (!version->is_integer() || version->as_integer() != 1)
    throw Error(Exit::data, name + "#/gonio", "is " + print_json(*version, -1) + ", this program reads version 1");
  for (const auto& [key, member] : d.original.as_object())
    if (!key.starts_with("x-") && std::ranges::find(section_names(), key) == section_names().end())
      unknown_key(key, section_names(), name + "#");
  for_each_section(d, [&d](const char* key, auto& section) {
    if (const Value* v = d.original.find(key)) read_section(section, *v, place(d, std::string("/") + key));
  });
  if (const Value* v = d.original.find("provenance")) {
    expect_object(*v, place(d, "/provenance"));
    d.provenance = *v;
  }
  check_references(d);
  return d;
}

Document read_document(const fs::path& path, const ReadOptions& options) {
  if (path == "-") {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    if (text.empty())
      throw Error(Exit::no_input, "standard input", "is empty", "pipe a manifest in, or name one with -i");
    return parse_document(text, "standard input", ".", options);
  }
  return parse_document(read_file(path), path.string(), path.parent_path(), options);
}

Value to_value(const Document& d, const fs::path& folder) {
  Value out = Value::object({{"gonio", 1}});
  Document copy = d;
  const fs::path target = fs::absolute(folder.empty() ? fs::path(".") : folder).lexically_normal();
  const fs::path source = fs::absolute(d.folder).lexically_normal();
  if (target != source)
    for (auto& [id, file] : copy.files)
      file.path = (source / file.path).lexically_normal().lexically_relative(target).generic_string();
  for_each_section(copy, [&](const char* key, auto& section) {
    const Value* original = d.original.find(key);
    Value v = write_section(section, original);
    if (!v.is_null()) out[key] = std::move(v);
  });
  for (const char* key : {"reliefs", "ground_noises"})
    if (const Value* v = d.original.find(key)) out[key] = *v;
  if (!d.provenance.as_object().empty() || d.original.find("provenance") != nullptr) out["provenance"] = d.provenance;
  if (d.original.is_object())
    for (const auto& [key, member] : d.original.as_object())
      if (key.starts_with("x-")) out[key] = member;
  return out;
}

std::string print_document(const Document& d, const fs::path& folder) {
  return print_json(to_value(d, folder)) + "\n";
}

fs::path resolve(const Document& d, const std::string& file_id, const std::string& user) {
  const auto found = d.files.find(file_id);
  const std::string where = place(d, user);
  if (found == d.files.end()) throw Error(Exit::data, where, "names file \"" + file_id + "\", which is not in files");
  const File& file = found->second;
  const std::string at = place(d, "/files/" + file_id);
  const fs::path path = (d.folder / file.path).lexically_normal();
  if (!d.allow_outside) {
    std::error_code ignored;
    const fs::path root = fs::weakly_canonical(fs::absolute(d.folder.empty() ? "." : d.folder), ignored);
    const fs::path inside = fs::weakly_canonical(fs::absolute(path), ignored).lexically_relative(root);
    if (inside.empty() || *inside.begin() == "..")
      throw Error(Exit::data, at + "/path", "\"" + file.path + "\" leaves the manifest's folder",
                  "move the file, or allow it with --allow-outside");
  }
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error) throw Error(Exit::no_input, at + "/path", "\"" + file.path + "\" cannot be read: " + error.message());
  if (file.bytes && *file.bytes != bytes)
    throw Error(Exit::data, at,
                "\"" + file.path + "\" has " + std::to_string(bytes) + " bytes, the manifest says " +
                    std::to_string(*file.bytes),
                "restore the file, or make the manifest anew");
  if (!file.sha256.empty() && sha256_of_file(path) != file.sha256)
    throw Error(Exit::data, at, "\"" + file.path + "\" has another SHA-256 than the manifest says",
                "restore the file, or make the manifest anew");
  return path;
}

std::string add_file(Document& d, const fs::path& path, const std::string& id) {
  File file;
  file.path = fs::absolute(path)
                  .lexically_normal()
                  .lexically_relative(fs::absolute(d.folder).lexically_normal())
                  .generic_string();
  file.bytes = fs::file_size(path);
  file.sha256 = sha256_of_file(path);
  std::string name = id;
  for (int n = 2; d.files.contains(name) && d.files[name].path != file.path; ++n) name = id + "-" + std::to_string(n);
  d.files[name] = file;
  return name;
}

}  // namespace gonio::manifest
