// See call.h.
#include "tools/glass-make/call.h"

#include <algorithm>
#include <chrono>

#include "base/assignment.h"
#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "glass/form.h"
#include "glass/make_cell.h"
#include "glass/turned_views.h"

namespace gonio::tools::glass_make {

using namespace gonio::glass;

namespace {

using cli::Type;
namespace fs = std::filesystem;

std::vector<std::string> form_names() {
  std::vector<std::string> names;
  for (const Form* form : all_forms()) names.emplace_back(form->id());
  std::ranges::sort(names);
  return names;
}

// Files of a folder with one of these endings, in the order of their names.
std::vector<fs::path> files_in(const cli::Invocation& call, const std::string& option,
                               const std::vector<std::string>& endings) {
  std::vector<fs::path> paths;
  if (!call.given(option)) return paths;
  const fs::path folder = call.text(option);
  if (!fs::is_directory(folder)) throw Error(Exit::no_input, folder.string(), "is no folder");
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::string ending = entry.path().extension().string();
    std::ranges::transform(ending, ending.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
    if (std::ranges::find(endings, ending) != endings.end()) paths.push_back(entry.path());
  }
  if (paths.empty()) {
    std::string all;
    for (const std::string& ending : endings) all += (all.empty() ? "" : ", ") + ending;
    throw Error(Exit::no_input, folder.string(), "holds no file that ends in " + all);
  }
  std::ranges::sort(paths);
  return paths;
}

std::pair<int, int> size_of(const std::string& text) {
  const auto cross = text.find('x');
  int size[2] = {0, 0};
  if (cross != std::string::npos) {
    const std::string pieces[2] = {text.substr(0, cross), text.substr(cross + 1)};
    for (int i = 0; i < 2; ++i)
      if (!pieces[i].empty() && pieces[i].size() < 6 &&
          std::ranges::all_of(pieces[i], [](char c) { return c >= '0' && c <= '9'; }))
        size[i] = std::stoi(pieces[i]);
  }
  for (const int n : size)
    if (n < 16 || n > 4096 || n % 2 != 0)
      throw Error(Exit::usage, "--size", "\"" + text + "\" is no size of a picture",
                  "two even numbers between 16 and 4096, such as 128x128: super-pixels are 2 x 2");
  return {size[0], size[1]};
}

SetWish wish_of(const cli::Invocation& call) {
  SetWish wish;
  wish.seed = call.seed;
  wish.forms = call.texts("form");
  wish.meshes = files_in(call, "meshes", {".ply", ".stl", ".obj", ".3mf"});
  wish.surroundings = files_in(call, "surroundings", {".exr", ".hdr", ".png", ".jpg"});
  wish.objects = static_cast<std::size_t>(call.given("objects") || wish.meshes.empty()
                                              ? call.integer("objects")
                                              : static_cast<std::int64_t>(wish.meshes.size()));
  wish.views = static_cast<std::size_t>(call.integer("views"));
  std::tie(wish.width_px, wish.height_px) = size_of(call.text("size"));
  wish.relative_error = call.number("noise");
  wish.most_spp = static_cast<int>(call.integer("spp"));
  return wish;
}

// "I/N": cells of the I-th of N parts, I from 1.
struct Shard {
  std::size_t part = 1, of = 1;
};
Shard shard_of(const cli::Invocation& call) {
  if (!call.given("shard")) return {};
  const std::string& text = call.text("shard");
  Shard shard{0, 0};
  if (const auto slash = text.find('/'); slash != std::string::npos && slash > 0 && text.size() < 20 &&
                                         text.find_first_not_of("0123456789/") == std::string::npos &&
                                         slash + 1 < text.size())
    shard = {std::stoul(text.substr(0, slash)), std::stoul(text.substr(slash + 1))};
  if (shard.part < 1 || shard.part > shard.of)
    throw Error(Exit::usage, "--shard", "\"" + text + "\" is no part of a whole", "type I/N with 1 <= I <= N, as 3/64");
  return shard;
}

std::vector<std::size_t> cells_asked(const cli::Invocation& call, const GlassSet& set) {
  std::vector<std::size_t> all;
  for (const std::string& text : call.texts("cell")) {
    if (text.empty() || text.size() > 12 || text.find_first_not_of("0123456789") != std::string::npos)
      throw Error(Exit::usage, "--cell", "\"" + text + "\" is no number of a cell", "they count from 0");
    all.push_back(std::stoul(text));
    if (all.back() >= set.cells())
      throw Error(Exit::usage, "--cell", text + " is none of " + std::to_string(set.cells()) + " cells",
                  "they count from 0");
  }
  if (!all.empty()) return all;
  const Shard shard = shard_of(call);
  for (std::size_t n = (shard.part - 1) * set.cells() / shard.of; n < shard.part * set.cells() / shard.of; ++n)
    all.push_back(n);
  return all;
}

std::vector<std::size_t> recordings_asked(const cli::Invocation& call, const GlassSet& set) {
  std::vector<std::size_t> all;
  for (const std::string& text : call.texts("recording")) {
    if (text.empty() || text.size() > 12 || text.find_first_not_of("0123456789") != std::string::npos)
      throw Error(Exit::usage, "--recording", "\"" + text + "\" is no number of an object", "they count from 0");
    all.push_back(std::stoul(text));
    if (all.back() >= set.wish().objects)
      throw Error(Exit::usage, "--recording", text + " is none of " + std::to_string(set.wish().objects) + " objects",
                  "they count from 0");
  }
  return all;
}

bool is_part(const cli::Invocation& call) {
  return call.given("shard") || !call.texts("cell").empty();
}

void make_cells(cli::Invocation& call, const GlassSet& set) {
  const std::vector<std::size_t> numbers = cells_asked(call, set);
  Progress progress("cells", numbers.size());
  const auto start = std::chrono::steady_clock::now();
  std::size_t made = 0;
  for (const std::size_t n : numbers) {
    throw_if_interrupted();
    const Cell cell = set.cell(n);
    if (is_made(set, cell) && !call.resume)
      throw Error(Exit::cannot_create, set.folder_of(cell).string(), "is there already",
                  "--resume keeps finished cells and makes the others");
    made += make_cell(set, cell) ? 1 : 0;
    if (is_part(call)) manifest::add_file(call.document, set.folder_of(cell) / "cell.json", "cell-" + cell.name);
    progress.advance();
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  if (made > 0)
    log(LogLevel::info, format("%zu cells made, %zu kept, %.3g s a cell", made, numbers.size() - made,
                               spent.count() / static_cast<double>(made)));
}

void put_together(cli::Invocation& call, const GlassSet& set) {
  Progress progress("gathered", set.cells());
  const Gathered gathered = gather(set, call.out, [&] { progress.advance(); });
  const fs::path table = call.out / "cells.csv", page = call.out / "report.html";
  write_file(table, table_of(gathered));
  write_file(page, page_of(set, gathered));
  manifest::add_file(call.document, table, "cells");
  for (const fs::path& path : gathered.tensors) manifest::add_file(call.document, path, path.stem().string());
  for (const std::size_t object : recordings_asked(call, set)) {
    const fs::path path = call.out / format("object-%zu.json", object);
    write_file(path, manifest::print_document(turned_views(set, object), call.out));
    manifest::add_file(call.document, path, path.stem().string());
  }
}

}  // namespace

std::vector<cli::Option> options() {
  return {
      {.name = "objects",
       .type = Type::integer,
       .help = "How many objects. With --meshes: as many as there are files.",
       .preset = "10",
       .lower = 1,
       .upper = 1e7},
      {.name = "views",
       .type = Type::integer,
       .help = "Views of each object: each is a cell.",
       .preset = "5",
       .lower = 1,
       .upper = 1e5},
      {.name = "form",
       .type = Type::choice,
       .help = "Draw objects from this family only.",
       .choices = form_names(),
       .repeat = true,
       .conflicts = {"meshes"}},
      {.name = "meshes",
       .type = Type::folder,
       .help = "Take the closed meshes of this folder (PLY, STL, OBJ, 3MF) instead; each is scaled to fit."},
      {.name = "surroundings",
       .type = Type::folder,
       .help = "Take the latitude-longitude pictures of this folder for the room, instead of drawn ones."},
      {.name = "size",
       .type = Type::text,
       .help = "Of the pictures, in pixels.",
       .metavar = "WxH",
       .preset = "128x128"},
      {.name = "noise",
       .type = Type::quantity,
       .help = "Render each picture until its relative error is this small.",
       .preset = "10%",
       .dimension = Dimension::ratio,
       .lower = 1e-3,
       .upper = 1},
      {.name = "spp",
       .type = Type::integer,
       .help = "Most samples per pixel, whatever the noise.",
       .preset = "512",
       .lower = 16,
       .upper = 1 << 20},
      {.name = "shard",
       .type = Type::text,
       .help = "Make the I-th of N parts of the cells, and gather nothing.",
       .metavar = "I/N"},
      {.name = "cell",
       .type = Type::text,
       .help = "Make this cell, counted from 0, and gather nothing.",
       .metavar = "NUMBER",
       .repeat = true,
       .conflicts = {"shard"}},
      {.name = "recording",
       .type = Type::text,
       .help =
           "Write the views of this object, counted from 0, as one recording without the object: object-NUMBER.json.",
       .metavar = "NUMBER",
       .repeat = true,
       .conflicts = {"shard", "cell"}},
      {.name = "gather",
       .type = Type::flag,
       .help = "Make no cell: put finished ones together.",
       .conflicts = {"shard", "cell"}},
  };
}

void check(cli::Invocation& call) {
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the set's folder");
  shard_of(call);
  wish_of(call);
  for (const char* name : {"cells.csv", "report.html"})
    if (!is_part(call) && !call.force && !call.resume && fs::exists(call.out / name))
      throw Error(Exit::cannot_create, (call.out / name).string(), "is there already", "--force replaces it");
}

Exit run(cli::Invocation& call) {
  SetWish wish = wish_of(call);
  for (const auto& paths : {wish.meshes, wish.surroundings})
    for (const fs::path& path : paths) call.note_input(path);
  const GlassSet set(std::move(wish), call.out);
  recordings_asked(call, set);
  if (!call.flag("gather")) make_cells(call, set);
  if (!is_part(call)) put_together(call, set);
  return Exit::done;
}

}  // namespace gonio::tools::glass_make
