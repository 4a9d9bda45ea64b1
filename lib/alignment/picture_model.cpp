// See picture_model.h.
#include "alignment/picture_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "relighting/followed.h"
#include "relighting/recast.h"
#include "relighting/sampled_pixels.h"
#include "relighting/surface_samples.h"
#include "relighting/textures.h"
#include "scene/scene.h"

namespace gonio::alignment {
namespace {

using namespace relighting;
using manifest::Document;

constexpr CacheOptions fine{.paths = 128};
constexpr CacheOptions coarse{.samples = 4, .paths = 0, .patches = 1, .penumbrae = false};
constexpr double most_looked_at = 400000;  // pixels of a view, of which rows are drawn
constexpr double ground_share = 0.5;       // of its rows over those of bodies

// Photographs that show no rim (a place without its object) are left out.
Document of_sighted(const Document& document, const AlignmentInput& in) {
  Document d = document;
  for (manifest::ImageEntry& entry : d.images)
    if (std::ranges::none_of(in.rims, [&](const SeenRim& rim) { return rim.image == entry.id; })) entry.weight = 0;
  return d;
}

// Numbers of brightness that are free in an image, by name: "" where all is stated.
std::string unknown_brightness(const Document& d, const Recordings& recordings, const Recording& image) {
  std::string name;
  const auto add = [&](const manifest::Parameter& p, const std::string& own) {
    if (p.free) name += (p.share.empty() ? own : "=" + p.share) + ";";
  };
  for (const std::size_t l : image.lights)
    for (const char* key : {"watt_per_sr", "watt_per_m2"}) {
      const auto& parameters = d.lights.at(recordings.lights[l]).parameters;
      if (const auto found = parameters.find(key); found != parameters.end())
        add(found->second, "light " + recordings.lights[l]);
    }
  add(image.gain, "image " + image.id);
  return name;
}

std::shared_ptr<const mesh::Mesh> grown(const mesh::Mesh& mesh, Vec3 centre, Vec3 factor) {
  auto out = std::make_shared<mesh::Mesh>(mesh);
  for (Vec3& p : out->positions_m) p = centre + factor * (p - centre);
  for (Vec3& n : out->normals) n = normalized(Vec3{n.x / factor.x, n.y / factor.y, n.z / factor.z});
  return out;
}

}  // namespace

void check_pictures(const Document& document, const AlignmentInput& in) {
  for (const manifest::Object& object : document.objects) {
    const bool asked = object.id == in.ground || std::ranges::count(in.bodies, object.id) > 0;
    if (!asked || followed(document, object.surface) != Followed::not_at_all) continue;
    throw Error(Exit::data, manifest::place(document, "/surfaces/" + object.surface),
                "is glass, a mirror or a body that light enters, and \"" + object.id +
                    "\" has it: the fast image model does not follow light there",
                "leave out --picture, or state a surface that stays outside");
  }
  for (const SeenRim& rim : in.rims) {
    const std::size_t i = *manifest::index_of_image(document, rim.image);
    if (document.images[i].file.empty())
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i) + "/file"), "is missing",
                  "--picture compares photographs; give this image its file, or leave out --picture");
  }
  check_lights(of_sighted(document, in));
}

struct PictureModel::Impl {
  Impl(const Document& given, const AlignmentInput& input, const Setting& setting, double pixels)
      : document(of_sighted(given, input)),
        in(input),
        at(setting),
        recordings(read_recordings(document)),
        scene(scene::build_scene(document)),
        caster(scene.instances),
        tints(scene) {
    for (const scene::Surface& surface : scene.appearance.surfaces) surfaces.push_back(surface.id);
    layout = read_scene(document, recordings, surfaces, scene.centre_m);
    settle_textures(scene, layout);
    monomials = std::make_unique<render::Monomials>(surfaces.size(), degree_for(surfaces.size()));
    find_places();
    layout.lights = lights_in(at);
    set_up(pixels);
    fill_rows();
    coarse_start = changes(at);
  }

  // Where the setting's numbers are in the scene.
  void find_places() {
    for (const std::string& id : in.bodies) body_instance.push_back(instance_of(id));
    if (!in.ground.empty()) ground_instance = instance_of(in.ground);
    for (const std::string& lamp : in.lamps) {
      const auto found = std::ranges::find(recordings.lights, lamp);
      if (found == recordings.lights.end())
        lamp_light.push_back({});
      else
        lamp_light.push_back(static_cast<std::size_t>(found - recordings.lights.begin()));
    }
    view_station.resize(recordings.views.size());
    for (const Recording& image : recordings.images) {
      images.push_back(image.id);
      for (std::size_t s = 0; s < in.images_of_station.size(); ++s)
        if (std::ranges::count(in.images_of_station[s], image.id) > 0) view_station[image.view] = s;
    }
    std::map<std::string, std::size_t> known;
    for (const Recording& image : recordings.images)
      brightness.push_back(
          known.try_emplace(unknown_brightness(document, recordings, image), known.size()).first->second);
  }
  std::size_t instance_of(const std::string& id) const {
    const auto found = std::ranges::find(scene.instances, id, &scene::Instance::id);
    return static_cast<std::size_t>(found - scene.instances.begin());
  }

  std::vector<LightSource> lights_in(const Setting& s) const {
    std::vector<LightSource> lights = layout.lights;
    for (std::size_t l = 0; l < lamp_light.size(); ++l)
      if (lamp_light[l] && !lights[*lamp_light[l]].directional) lights[*lamp_light[l]].position_m = s.lamps_m[l];
    return lights;
  }
  View view_in(const Setting& s, std::size_t v) const {
    View view = recordings.views[v];
    if (!view_station[v]) return view;
    const Station &from = at.stations[*view_station[v]], &to = s.stations[*view_station[v]];
    if (!(from.world_from_camera == to.world_from_camera))
      view.world_from_camera = to.world_from_camera * inverse(from.world_from_camera) * view.world_from_camera;
    const double factor = s.lenses[to.lens].fx_px / at.lenses[from.lens].fx_px;
    if (factor != 1) {
      camera::Intrinsics lens = view.model.intrinsics();
      lens.fx_px *= factor, lens.fy_px *= factor;
      view.model = view.model.with(lens);
    }
    return view;
  }
  std::vector<scene::Instance> instances_in(const Setting& s) const {
    std::vector<scene::Instance> instances = scene.instances;
    for (std::size_t b = 0; b < body_instance.size(); ++b) {
      const Body &from = at.bodies[b], &to = s.bodies[b];
      scene::Instance& instance = instances[body_instance[b]];
      if (!(from.world_from_object == to.world_from_object))
        instance.world_from_object =
            to.world_from_object * inverse(from.world_from_object) * instance.world_from_object;
      const Vec3 factor{to.scale.x / from.scale.x, to.scale.y / from.scale.y, to.scale.z / from.scale.z};
      if (!(factor == Vec3{1, 1, 1}))
        instance.shape =
            grown(*std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape), from.shape->centre_m(), factor);
    }
    if (ground_instance && s.ground) {
      scene::Instance& plane = instances[*ground_instance];
      plane.world_from_object = carried_along(plane.world_from_object, *at.ground, *s.ground, ground_axes(at).pivot_m);
    }
    return instances;
  }

  // Whether about a pixel one instance alone is seen, and which.
  std::optional<std::size_t> alone(std::size_t v, std::array<int, 2> pixel) const {
    std::optional<std::size_t> seen;
    for (const Vec2& offset : around) {
      const auto met = meet(v, Vec2{double(pixel[0]), double(pixel[1])} + offset);
      if (!met || (seen && *seen != met->instance)) return {};
      seen = met->instance;
    }
    return seen;
  }
  std::optional<render::SurfacePoint> meet(std::size_t v, Vec2 place) const {
    const View& view = recordings.views[v];
    const camera::Ray ray = view.model.ray(place);
    return caster.closest(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction));
  }
  bool is_body(std::size_t instance) const { return std::ranges::count(body_instance, instance) > 0; }

  void set_up(double pixels) {
    for (std::size_t v = 0; v < recordings.views.size(); ++v) {
      const int width = recordings.views[v].model.width_px();
      std::vector<std::uint8_t> marked = counted_pixels(recordings, v);
      const int stride = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(marked.size()) / most_looked_at)));
      std::array<double, 2> met{};  // bodies, ground
      for (std::size_t i = 0; i < marked.size(); ++i) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        if (!marked[i] || x % stride != 0 || y % stride != 0) {
          marked[i] = 0;
          continue;
        }
        const auto point = meet(v, {double(x), double(y)});
        const bool body = point && is_body(point->instance), ground = point && ground_instance == point->instance;
        marked[i] = body || ground;
        met[0] += body, met[1] += ground;
      }
      const double share = std::min(1.0, ground_share * met[0] / std::max(1.0, met[1]));
      const double count = std::max(200.0, pixels / static_cast<double>(recordings.images.size()));
      // Of tiles of ground few are taken: as if there were no more of it.
      const double aimed = count * (met[0] + met[1]) / std::max(1.0, met[0] + share * met[1]);
      chosen.push_back(choose_pixels(recordings, v, marked, aimed, [](std::array<int, 2>, Random&) { return true; }));
      thin(v, share);
      fine_caches.push_back(build_cache(caster, view_in(at, v), layout.lights, *monomials, chosen.back(), fine));
      tints.apply(caster, view_in(at, v), fine_caches.back());
    }
    model = std::make_unique<ImageModel>(recordings, layout, *monomials, fine_caches);
    const relighting::Setting s{document, scene, caster, recordings, layout, *model, nullptr, &shared};
    std::vector<Use> uses = given_uses(s);
    for (Use& use : uses)
      if (use.term->prepare) use.prepared = use.term->prepare(s, use);
    model->add_uses(std::move(uses), true);
  }
  void thin(std::size_t v, double share) {
    Random random(21, v);
    std::erase_if(chosen[v], [&](const std::array<int, 2>& pixel) {
      const auto seen = alone(v, pixel);
      return !seen || (!is_body(*seen) && random.uniform() >= share);
    });
  }

  // Lit by a lamp as a whole, or not at all, by each; and by one of them.
  bool evenly_lit(const Recording& image, std::array<int, 2> pixel) const {
    bool any = false;
    for (const std::size_t l : image.lights) {
      std::size_t lit = 0;
      for (const Vec2& offset : around) {
        const auto met = meet(image.view, Vec2{double(pixel[0]), double(pixel[1])} + offset);
        lit += met && received(caster, *met, layout.lights[l]) > 0;
      }
      if (lit != 0 && lit != around.size()) return false;
      any = any || lit > 0;
    }
    return any;
  }

  void fill_rows() {
    for (std::size_t g = 0; g < recordings.images.size(); ++g) {
      const Recording& image = recordings.images[g];
      const ViewCache& cache = model->cache(image.view);
      std::vector<std::uint32_t> mine;
      for (std::uint32_t p = 0; p < cache.pixels.size(); ++p) {
        const Pixel& pixel = cache.pixels[p];
        const std::size_t i = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(image.picture.width) +
                              static_cast<std::size_t>(pixel.x);
        if (image.counts[i] && pixel.facets == 1 && evenly_lit(image, {pixel.x, pixel.y})) mine.push_back(p);
      }
      std::vector<double> values(3 * mine.size()), own(3 * mine.size());
      model->predict(model->layout().start, g, mine, values);
      model->variance(model->layout().start, g, mine, own);
      states.push_back(model->edited(model->layout().start, g));
      for (std::size_t i = 0; i < mine.size(); ++i) {
        const Pixel& pixel = cache.pixels[mine[i]];
        PictureRow row{g, image.view, mine[i], pixel.x, pixel.y, cache.facets[pixel.first_facet].surface, {}, {}};
        const Rgb mean = local_mean(image, pixel.x, pixel.y);
        const std::size_t place =
            3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(image.picture.width) +
                 static_cast<std::size_t>(pixel.x));
        std::array<double, 3> seen{}, variance{};
        for (std::size_t c = 0; c < 3; ++c) {
          seen[c] = image.picture.data[place + c];
          const double noise = noise_sigma(image, mean[static_cast<int>(c)], place + c);
          variance[c] = noise * noise + own[3 * i + c];
        }
        row.observed = {seen[0], seen[1], seen[2]}, row.variance = {variance[0], variance[1], variance[2]};
        rows.push_back(row);
      }
      start.insert(start.end(), values.begin(), values.end());
      picked.push_back(std::move(mine));
    }
  }

  // M of the head, three values for each row.
  std::vector<double> changes(const Setting& s) const {
    const std::vector<scene::Instance> instances = instances_in(s);
    const render::RayCaster there(instances);
    SceneLayout moved = layout;
    moved.lights = lights_in(s);
    std::vector<ViewCache> caches;
    for (std::size_t v = 0; v < chosen.size(); ++v) {
      const View view = view_in(s, v);
      caches.push_back(build_cache(there, view, moved.lights, *monomials, chosen[v], coarse));
      lend_indirect(model->cache(v), caches.back());
      tints.apply(there, view, caches.back());
    }
    const ImageModel plain(recordings, moved, *monomials, std::move(caches));
    std::vector<double> out;
    for (std::size_t g = 0; g < picked.size(); ++g) {
      std::vector<double> values(3 * picked[g].size());
      plain.predict(states[g], g, picked[g], values);
      out.insert(out.end(), values.begin(), values.end());
    }
    return out;
  }

  const Document document;
  const AlignmentInput& in;
  const Setting at;
  const Recordings recordings;
  const scene::Scene scene;
  const render::RayCaster caster;
  const Tints tints;
  std::vector<std::string> surfaces, images;
  std::vector<std::size_t> brightness, body_instance;
  std::optional<std::size_t> ground_instance;
  std::vector<std::optional<std::size_t>> lamp_light, view_station;
  SceneLayout layout;
  std::unique_ptr<render::Monomials> monomials;
  Shared shared;
  std::vector<std::vector<std::array<int, 2>>> chosen;  // [view]
  std::vector<ViewCache> fine_caches;
  std::unique_ptr<ImageModel> model;
  std::vector<PictureRow> rows;
  std::vector<SceneState> states;                  // [image]
  std::vector<std::vector<std::uint32_t>> picked;  // [image]
  std::vector<double> start, coarse_start;
  static constexpr double side = margin_px, slant = 0.7071 * margin_px;
  static constexpr std::array<Vec2, 9> around{{{0, 0},
                                               {side, 0},
                                               {-side, 0},
                                               {0, side},
                                               {0, -side},
                                               {slant, slant},
                                               {slant, -slant},
                                               {-slant, slant},
                                               {-slant, -slant}}};
};

PictureModel::PictureModel(const Document& document, const AlignmentInput& in, const Setting& at, double pixels)
    : impl_(std::make_unique<Impl>(document, in, at, pixels)) {}
PictureModel::~PictureModel() = default;

const std::vector<PictureRow>& PictureModel::rows() const {
  return impl_->rows;
}
const std::vector<std::string>& PictureModel::images() const {
  return impl_->images;
}
const std::vector<std::string>& PictureModel::surfaces() const {
  return impl_->surfaces;
}
const std::vector<std::size_t>& PictureModel::brightness() const {
  return impl_->brightness;
}
std::vector<double> PictureModel::predict(const Setting& setting) const {
  std::vector<double> out = impl_->changes(setting);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += impl_->start[i] - impl_->coarse_start[i];
  return out;
}

}  // namespace gonio::alignment
