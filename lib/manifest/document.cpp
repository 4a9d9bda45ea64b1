// Reading and printing of the whole document. A section that a program did not change is written as it was read: what
// to_value() prints for an entry is compared with what it would print for the entry as read, and where the two agree
// the original stands.
#include "manifest/document.h"

#include <algorithm>
#include <iostream>
#include <iterator>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "manifest/document_references.h"
#include "manifest/explanation_tables.h"
#include "manifest/file_paths.h"
#include "manifest/frame_loops.h"
#include "manifest/section_tables.h"
#include "manifest/sections/acceptance.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/colour_correction.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/contrast.h"
#include "manifest/sections/environment.h"
#include "manifest/sections/evaluation.h"
#include "manifest/sections/explanation.h"
#include "manifest/sections/file.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/object.h"
#include "manifest/sections/pattern.h"
#include "manifest/sections/placement.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/print.h"
#include "manifest/sections/projection.h"
#include "manifest/sections/provenance.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/registration.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/rig.h"
#include "manifest/sections/robot.h"
#include "manifest/sections/sequence.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "manifest/sections/volume.h"

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
  visit("colour", d.colour);
  visit("meshes", d.meshes);
  visit("surfaces", d.surfaces);
  visit("environments", d.environments);
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
  visit("projections", d.projections);
  visit("clouds", d.clouds);
  visit("registration", d.registration);
  visit("outlines", d.outlines);
  visit("alignments", d.alignments);
  visit("contrasts", d.contrasts);
  visit("reliefs", d.reliefs);
  visit("ground_noises", d.ground_noises);
  visit("prints", d.prints);
  visit("volumes", d.volumes);
  visit("markers", d.markers);
  visit("placements", d.placements);
  visit("laboratory", d.laboratory);
  visit("plans", d.plans);
  visit("runs", d.runs);
  visit("sequences", d.sequences);
  visit("reconstructions", d.reconstructions);
  visit("evaluations", d.evaluations);
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

template <class T>
void read_section(AtMostOne<T>& section, const Value& v, const std::string& place) {
  section.entry = {Codec<T>::read(v, place)};
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

template <class T>
Value write_section(const AtMostOne<T>& section, const Value* original) {
  return section.entry.empty() ? Value() : write_entry(section.entry.front(), original);
}

const std::vector<std::string>& section_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out{"gonio", "provenance"};
    Document d;
    for_each_section(d, [&out](const char* key, auto&) { out.emplace_back(key); });
    return out;
  }();
  return names;
}

}  // namespace

Document::Document() = default;
Document::~Document() = default;
Document::Document(const Document&) = default;
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(const Document&) = default;
Document& Document::operator=(Document&&) noexcept = default;

std::vector<std::string> names_in(const Document& document, std::string_view section) {
  std::vector<std::string> names;
  bool known = false;
  for_each_section(document, [&]<class Section>(const char* key, const Section& entries) {
    if (section != key) return;
    known = true;
    if constexpr (requires { entries.begin()->first; })
      for (const auto& [name, entry] : entries) names.push_back(name);
    else if constexpr (requires { entries.front().id; })
      for (const auto& entry : entries) names.push_back(entry.id);
  });
  if (!known) throw Error(Exit::internal, document.name, "is asked for the section \"" + std::string(section) + "\"");
  return names;
}

bool has_entry(const Document& document, std::string_view section, const std::string& name) {
  const auto names = names_in(document, section);
  return std::ranges::find(names, name) != names.end();
}

const Camera* find_camera(const Document& document, const std::string& name) {
  const auto found = document.cameras.find(name);
  return found == document.cameras.end() ? nullptr : &found->second;
}

std::string place(const Document& document, const std::string& pointer) {
  return document.name + "#" + pointer;
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
  for (std::size_t i = 0; i < d.explanations.size(); ++i)
    Codec<ExplanationEntry>::read(d.explanations[i], item(place(d, "/explanations"), i));
  if (const Value* v = d.original.find("provenance")) {
    Codec<Provenance>::read(*v, place(d, "/provenance"));  // refuses what is none
    d.provenance = *v;
  }
  check_references(d);
  check_frames(d);
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
  move_to_folder(copy, folder);
  for_each_section(copy, [&](const char* key, auto& section) {
    const Value* original = d.original.find(key);
    Value v = write_section(section, original);
    if (!v.is_null()) out[key] = std::move(v);
  });
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
  const fs::path path = place_of_entry(d.folder, file.path);
  if (!d.allow_outside && !lies_within(path, d.folder))
    throw Error(Exit::data, at + "/path", "\"" + file.path + "\" leaves the manifest's folder",
                "move the file, or allow it with --allow-outside");
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error)
    throw Error(Exit::no_input, at + "/path", "\"" + file.path + "\" cannot be read: " + error.message(),
                "check the path and its permissions");
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
  file.path = entry_for(path, d.folder);
  file.bytes = fs::file_size(path);
  file.sha256 = sha256_of_file(path);
  std::string name = id;
  for (int n = 2; d.files.contains(name) && d.files[name].path != file.path; ++n) name = id + "-" + std::to_string(n);
  d.files[name] = file;
  return name;
}

}  // namespace gonio::manifest
