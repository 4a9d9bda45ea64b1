// See make_cell.h.
#include "glass/make_cell.h"

#include "base/atomic_file.h"
#include "base/text.h"
#include "io/exr.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "render/entries.h"
#include "render/sensor_chain.h"
#include "render/session.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;

constexpr const char* manifest_name = "cell.json";

render::SessionOptions options_of(const GlassSet& set, const Cell& cell) {
  render::SessionOptions options;
  options.transport.stokes = true;
  options.seed = split_mix(set.wish().seed) ^ cell.number;
  options.seed >>= 12;  // readers of JSON keep 53 bits
  options.spp = set.wish().most_spp, options.relative_error = set.wish().relative_error;
  options.resume = true;
  return options;
}

io::ExrAttributes head_of(const Cell& cell, const render::Facts& facts, const io::Image& picture) {
  io::ExrAttributes head = render::attributes_of(facts, picture);
  for (const auto& [name, value] : cell.facts) head["cell." + name] = value;
  return head;
}

render::Facts make_image(const render::Session& session, const Cell& cell, std::size_t image, const fs::path& picture,
                         const fs::path& mosaic) {
  if (fs::exists(mosaic))
    if (const auto finished = session.finished(image, picture)) return *finished;
  const render::Rendered rendered = session.render(image, picture);
  const std::string id = manifest::names_in(cell.scene, "images")[image];
  const io::Image read =
      render::recorded(rendered.picture, render::sensor_of(cell.scene, image), id, rendered.facts.seed);
  io::write_picture(mosaic, read);
  write_file(picture, io::encode_exr(rendered.picture, head_of(cell, rendered.facts, rendered.picture)));
  render::Session::remove_checkpoint(picture);
  return rendered.facts;
}

manifest::Step step_of(const GlassSet& set, const Cell& cell) {
  manifest::Step step;
  step.program = "glass-make", step.version = GONIO_VERSION;
  step.options = manifest::Value::object({{"seed", set.wish().seed},
                                          {"object", static_cast<std::int64_t>(cell.object)},
                                          {"view", static_cast<std::int64_t>(cell.view)},
                                          {"noise", set.wish().relative_error},
                                          {"spp", set.wish().most_spp}});
  return step;
}

}  // namespace

bool is_made(const GlassSet& set, const Cell& cell) {
  return fs::exists(set.folder_of(cell) / manifest_name);
}

bool make_cell(const GlassSet& set, const Cell& cell) {
  if (is_made(set, cell)) return false;
  const fs::path folder = set.folder_of(cell);
  make_folder(folder);
  const render::Session session(cell.scene, options_of(set, cell), [](const fs::path&) {});
  manifest::Document made = cell.scene;
  const std::vector<std::string> images = manifest::names_in(made, "images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    const fs::path picture = folder / (images[i] + ".exr"), mosaic = folder / (images[i] + "-mosaic.exr");
    const render::Facts facts = make_image(session, cell, i, picture, mosaic);
    render::enter_rendering(made, i, picture, facts, {}, {{"mosaic", mosaic}});
  }
  manifest::record_step(made, step_of(set, cell));
  write_file(folder / manifest_name, manifest::print_document(made, folder));
  return true;
}

}  // namespace gonio::glass
