// See found_masks.h.
#include "alignment/found_masks.h"

#include <algorithm>
#include <optional>

#include "alignment/segmentation.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "photograph/linear_picture.h"

namespace gonio::alignment {
namespace {

using manifest::Document;

std::string image_place(const Document& d, std::size_t i) {
  return manifest::place(d, "/images/" + std::to_string(i));
}

std::string object_of(const Document& d, const std::string& wished) {
  if (!wished.empty()) return wished;
  std::string found;
  for (const manifest::Object& object : d.objects) {
    if (object.mesh.empty() || d.meshes.at(object.mesh).file.empty()) continue;
    if (!found.empty())
      throw Error(Exit::usage, "--object", "is missing: there are \"" + found + "\" and \"" + object.id + "\"",
                  "masks are found of one object");
    found = object.id;
  }
  if (found.empty()) throw Error(Exit::data, manifest::place(d, "/objects"), "have no mesh from a file");
  return found;
}

io::Image picture_of(const Document& d, std::size_t i, const std::function<void(const std::filesystem::path&)>& note) {
  const auto path = manifest::picture_path(d, i);
  if (note) note(path);
  return photograph::read_linear(path, d.images[i].response, image_place(d, i), d.images[i].saturation).colour;
}

std::vector<Label> strokes_of(const std::filesystem::path& path, const io::Image& picture) {
  const io::Image drawn = io::read_picture(path);
  if (drawn.width != picture.width || drawn.height != picture.height)
    throw Error(Exit::data, path.string(), "has another size than its photograph", "draw on a copy of it");
  if (drawn.channel("R") < 0) throw Error(Exit::data, path.string(), "has no colours", "draw red, blue and green");
  std::vector<Label> labels(drawn.pixels(), Label::unknown);
  const int r = drawn.channel("R"), g = drawn.channel("G"), b = drawn.channel("B");
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) {
      const auto pure = [&](int one, int two, int three) {
        return drawn.at(x, y, one) > 0.8F && drawn.at(x, y, two) < 0.2F && drawn.at(x, y, three) < 0.2F;
      };
      Label& label =
          labels[static_cast<std::size_t>(y) * static_cast<std::size_t>(drawn.width) + static_cast<std::size_t>(x)];
      if (pure(r, g, b)) label = Label::object;
      if (pure(b, r, g)) label = Label::shadow;
      if (pure(g, r, b)) label = Label::ground;
    }
  return labels;
}

// Images that one camera took from one place.
std::vector<std::vector<std::size_t>> places_of(const Document& d, const std::vector<std::size_t>& images) {
  std::vector<std::vector<std::size_t>> groups;
  for (const std::size_t i : images) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
      const manifest::ImageEntry &a = d.images[g.front()], &b = d.images[i];
      return a.camera == b.camera && a.world_from_camera == b.world_from_camera;
    });
    if (group == groups.end())
      groups.push_back({i});
    else
      group->push_back(i);
  }
  return groups;
}

class Finder {
 public:
  Finder(Document& document, const MaskWish& wish,
         const std::function<std::filesystem::path(const std::string&)>& output_path,
         const std::function<void(const std::filesystem::path&)>& note)
      : d_(document), wish_(wish), object_(object_of(document, wish.object)), output_path_(output_path), note_(note) {}

  void run() {
    std::vector<std::size_t> images;
    for (std::size_t i = 0; i < d_.images.size(); ++i) {
      const manifest::ImageEntry& image = d_.images[i];
      const auto is = [&](const auto& pair) { return pair.second == image.id; };
      const bool background = std::any_of(wish_.backgrounds.begin(), wish_.backgrounds.end(), is);
      const bool known =
          std::any_of(d_.outlines.begin(), d_.outlines.end(), [&](const auto& o) { return o.image == image.id; });
      if (!image.file.empty() && !image.camera.empty() && !background && !known) images.push_back(i);
    }
    if (images.empty()) throw Error(Exit::data, manifest::place(d_, "/images"), "have no photograph that lacks masks");
    if (wish_.by == MaskWish::By::lamps)
      for (const auto& group : places_of(d_, images)) by_lamps(group);
    else
      for (const std::size_t i : images) one(i);
  }

 private:
  manifest::Noise noise(std::size_t i) const { return d_.images[i].noise.value_or(manifest::Noise{}); }

  void by_lamps(const std::vector<std::size_t>& group) {
    if (group.size() < 2)
      throw Error(Exit::data, image_place(d_, group[0]), "is the only picture from its place",
                  "masks by lamps need two and more, each under another lamp; --masks alone takes one");
    std::vector<io::Image> pictures;
    for (const std::size_t i : group) pictures.push_back(picture_of(d_, i, note_));
    const auto found = segment_by_lamps(pictures, noise(group[0]), image_place(d_, group[0]));
    for (std::size_t k = 0; k < group.size(); ++k) enter(group[k], found[k]);
  }
  void one(std::size_t i) {
    const std::string& id = d_.images[i].id;
    const io::Image picture = picture_of(d_, i, note_);
    if (wish_.by == MaskWish::By::background) {
      const auto empty = wish_.backgrounds.find(id);
      if (empty == wish_.backgrounds.end())
        throw Error(Exit::usage, "--background", "names no empty picture for \"" + id + "\"",
                    "--background " + id + "=IMAGE");
      const auto index = manifest::index_of_image(d_, empty->second);
      if (!index) throw Error(Exit::usage, "--background", "names \"" + empty->second + "\", which is not in images");
      enter(i, segment_by_background(picture, picture_of(d_, *index, note_), noise(i), image_place(d_, i)));
    } else if (wish_.by == MaskWish::By::strokes) {
      const auto drawn = wish_.strokes.find(id);
      if (drawn == wish_.strokes.end())
        throw Error(Exit::usage, "--strokes", "are missing for \"" + id + "\"", "--strokes " + id + "=FILE");
      if (note_) note_(drawn->second);
      enter(i, segment_by_strokes(picture, strokes_of(drawn->second, picture), image_place(d_, i)));
    } else {
      enter(i, segment_alone(picture, noise(i), image_place(d_, i)));
    }
  }

  void enter(std::size_t i, const Segmentation& s) {
    const std::string& id = d_.images[i].id;
    if (s.certainty < 0.98)
      log(LogLevel::info,
          format("%s: of %.1f %% of the pixels nobody can tell what they show", id.c_str(), 100 * (1 - s.certainty)));
    const bool shadowed =
        std::count(s.labels.begin(), s.labels.end(), Label::shadow) >= 16 && d_.images[i].light.size() == 1;
    for (const std::string kind : {"object", "shadow"}) {
      const bool shadow = kind == "shadow";
      if (shadow && !shadowed) continue;
      io::Image mask(s.width, s.height, {"Y", "unknown"});
      for (std::size_t p = 0; p < s.labels.size(); ++p) {
        const float share = !shadow                  ? s.object_share[p]
                            : s.shadow_share.empty() ? (s.labels[p] == Label::shadow ? 1.0F : 0.0F)
                                                     : s.shadow_share[p];
        mask.data[2 * p] = share, mask.data[2 * p + 1] = s.labels[p] == Label::unknown ? 1.0F : 0.0F;
      }
      const auto path = output_path_(file_stem(id) + "-" + file_stem(object_) + "-" + kind + "-mask.exr");
      io::write_picture(path, mask);
      manifest::Outline outline;
      outline.image = id, outline.object = object_, outline.kind = kind;
      outline.mask = manifest::add_file(d_, path, "mask-" + id + "-" + object_ + "-" + kind);
      d_.outlines.push_back(std::move(outline));
    }
  }

  Document& d_;
  const MaskWish& wish_;
  std::string object_;
  const std::function<std::filesystem::path(const std::string&)>& output_path_;
  const std::function<void(const std::filesystem::path&)>& note_;
};

}  // namespace

void find_masks(Document& document, const MaskWish& wish,
                const std::function<std::filesystem::path(const std::string& name)>& output_path,
                const std::function<void(const std::filesystem::path&)>& note_input) {
  if (wish.by != MaskWish::By::given) Finder(document, wish, output_path, note_input).run();
}

}  // namespace gonio::alignment
