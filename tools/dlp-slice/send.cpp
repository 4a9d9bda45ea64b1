// Layers into the archive, from the platform on: drawn one after another, encoded several at a time, kept by none.
#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "io/grey.h"
#include "io/png_grey.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

struct Drawn {  // grey values of a box, not yet turned into the display's picture
  std::size_t index = 0;
  double bottom_m = 0, top_m = 0;
  print::PixelBox box{};
  std::vector<std::uint8_t> greys;
};

// Rows from the top are from the largest y on; mirrored as the display wants it. Until this thread's next call.
const std::vector<std::uint8_t>& picture_of(const Drawn& drawn, const print::Job& job) {
  thread_local std::vector<std::uint8_t> picture;
  picture.assign(static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px), 0);
  const int wide = drawn.box.x_end - drawn.box.x_begin;
  const bool flip_x = job.mirror_x.value_or(false), flip_y = job.mirror_y.value_or(false);
  for (int y = drawn.box.y_begin; y < drawn.box.y_end; ++y) {
    const std::uint8_t* from = drawn.greys.data() + static_cast<std::ptrdiff_t>(y - drawn.box.y_begin) * wide;
    std::uint8_t* row = picture.data() + static_cast<std::ptrdiff_t>(flip_y ? y : job.height_px - 1 - y) * job.width_px;
    if (flip_x)
      std::reverse_copy(from, from + wide, row + job.width_px - drawn.box.x_end);
    else
      std::copy_n(from, wide, row + drawn.box.x_begin);
  }
  return picture;
}

class Sender {
 public:
  Sender(Work& work, std::size_t layers)
      : work_(work),
        format_(print::archive_format(work.archive, work.call.given("format") ? work.call.text("format") : "")),
        job_(job_of(work)),
        layers_(layers),
        progress_("layers", layers) {
    job_.name = work.archive.stem().string();
    job_.printing_s = work.totals.time_s = time_of(work, layers);
    if (!work.bodies.empty()) job_.previews = previews_of(work);
    writer_ = format_.begin(work.archive, job_);
    cut_.width = work.printer.width_px, cut_.height = static_cast<int>(layers);
    cut_.greys.resize(static_cast<std::size_t>(cut_.width) * static_cast<std::size_t>(cut_.height));
  }

  void add(Drawn drawn) {
    note(drawn);
    pending_.push_back(std::move(drawn));
    if (pending_.size() >= 2 * static_cast<std::size_t>(threads())) flush();
  }

  void finish() {
    flush();
    writer_->job().resin_m3 = work_.totals.solid_m3;
    writer_->finish();
    for (const std::string& what : print::left_out(format_, job_))
      log(LogLevel::warning, std::string(format_.name) + " does not hold " + what);
    cut_.title = "Cut through all layers along x";
    crop(cut_);
    work_.sections.push_back(std::move(cut_));
  }

 private:
  void flush() {
    std::vector<std::string> encoded(pending_.size());
    parallel_for(0, pending_.size(),
                 [&](std::size_t k) { encoded[k] = format_.encode(job_, picture_of(pending_[k], job_)); });
    for (std::size_t k = 0; k < pending_.size(); ++k)
      writer_->add_encoded(encoded[k], pending_[k].bottom_m, pending_[k].top_m);
    progress_.advance(pending_.size());
    pending_.clear();
    throw_if_interrupted();
  }

  // What the page shows: six layers, and the row of pixels through the middle of each.
  void note(const Drawn& drawn) {
    const int wide = drawn.box.x_end - drawn.box.x_begin;
    if (middle_ < 0) middle_ = (drawn.box.y_begin + drawn.box.y_end) / 2;
    if (middle_ >= drawn.box.y_begin && middle_ < drawn.box.y_end)
      std::copy_n(
          drawn.greys.data() + static_cast<std::ptrdiff_t>(middle_ - drawn.box.y_begin) * wide, wide,
          cut_.greys.data() + static_cast<std::ptrdiff_t>(layers_ - 1 - drawn.index) * cut_.width + drawn.box.x_begin);
    const std::size_t every = std::max<std::size_t>(1, layers_ / 6);
    if (drawn.index % every != every / 2 && drawn.index + 1 != layers_) return;
    Section section{
        format("Layer %zu of %zu", drawn.index + 1, layers_), wide, drawn.box.y_end - drawn.box.y_begin, {}};
    for (int y = section.height; y-- > 0;)
      section.greys.insert(section.greys.end(), drawn.greys.begin() + static_cast<std::ptrdiff_t>(y) * wide,
                           drawn.greys.begin() + static_cast<std::ptrdiff_t>(y + 1) * wide);
    work_.sections.push_back(std::move(section));
  }

  static void crop(Section& cut) {  // dark columns at the sides
    int first = cut.width, last = 0;
    for (int y = 0; y < cut.height; ++y)
      for (int x = 0; x < cut.width; ++x)
        if (cut.greys[static_cast<std::size_t>(y) * static_cast<std::size_t>(cut.width) + static_cast<std::size_t>(x)] >
            0)
          first = std::min(first, x), last = std::max(last, x + 1);
    if (first >= last) return;
    Section narrow{cut.title, last - first, cut.height, {}};
    for (int y = 0; y < cut.height; ++y) {
      const auto row = cut.greys.begin() + static_cast<std::ptrdiff_t>(y) * cut.width;
      narrow.greys.insert(narrow.greys.end(), row + first, row + last);
    }
    cut = std::move(narrow);
  }

  Work& work_;
  const print::ArchiveFormat& format_;
  print::Job job_;
  std::unique_ptr<print::ArchiveWriter> writer_;
  std::vector<Drawn> pending_;
  Section cut_;
  int middle_ = -1;
  std::size_t layers_;
  Progress progress_;
};

void add_totals(Totals& totals, const print::LayerPicture& layer) {
  ++totals.layers;
  totals.solid_m3 += layer.solid_m3, totals.structured_m2 += layer.structured_m2;
  totals.unreached_m3 += layer.unreached_m3, totals.excess = std::max(totals.excess, layer.excess);
}

// Compensated layers of a call that was interrupted: greys as PNG in a folder beside the archive, under a key of all
// that they depend on. The folder goes when the archive is whole.
class Kept {
 public:
  Kept(const Work& work, const print::PixelBox& box) : folder_(work.archive.string() + ".compensated") {
    const std::string key = key_of(work, box);
    const std::filesystem::path file = folder_ / "key";
    if (!work.call.resume || !std::filesystem::exists(file) || read_file(file) != key) {
      std::filesystem::remove_all(folder_);
      make_folder(folder_);
      write_file(file, key);
    }
  }
  std::vector<std::uint8_t> operator()(std::size_t index) const {
    const std::filesystem::path file = folder_ / (std::to_string(index) + ".png");
    return std::filesystem::exists(file) ? io::read_grey(file).bytes : std::vector<std::uint8_t>();
  }
  void keep(const print::CompensatedLayer& layer) const {
    const std::filesystem::path file = folder_ / (std::to_string(layer.index) + ".png");
    if (!std::filesystem::exists(file))
      write_file(file, io::encode_png_of_grey_bytes(layer.greys,
                                                    static_cast<std::size_t>(layer.box.x_end - layer.box.x_begin)));
  }
  void done() const { std::filesystem::remove_all(folder_); }

 private:
  static std::string key_of(const Work& work, const print::PixelBox& box) {
    std::string text = format("%d %d %d %d %lld\n", box.x_begin, box.y_begin, box.x_end, box.y_end,
                              static_cast<long long>(work.call.integer("iterations")));
    for (const char* option : {"coverage", "axes"}) text += work.call.text(option) + "\n";
    if (work.call.given("direction")) text += work.call.text("direction") + "\n";
    text += format("%lld %lld %llu %.17g %d\n", static_cast<long long>(work.call.integer("samples")),
                   static_cast<long long>(work.call.integer("rays")), static_cast<unsigned long long>(work.call.seed),
                   work.call.number("texture-length"), work.call.flag("beneath") ? 1 : 0);
    const manifest::Print& entry = work.call.document.prints.at(work.printer.name);
    for (const auto& [name, use] : entry.microstructures)
      if (!use.file.empty()) text += sha256_of_file(manifest::resolve(work.call.document, use.file, name)) + "\n";
    for (const print::SlicedBody& body : work.bodies) {
      for (const Vec3& p : body.positions_m)
        text += shortest_text(p.x) + " " + shortest_text(p.y) + " " + shortest_text(p.z) + "\n";
      for (const auto& [a, b, c] : body.triangles) text += format("%u %u %u\n", a, b, c);
    }
    manifest::Document printer;
    printer.prints[work.printer.name] = entry;
    for (manifest::PrintedPart& part : printer.prints.begin()->second.parts) part.mesh.clear();
    printer.prints.begin()->second.layers.clear(), printer.prints.begin()->second.ground.clear();
    return sha256(text + manifest::print_document(printer, "."));
  }
  std::filesystem::path folder_;
};

void compensate(Work& work, print::Slicer& slicer, Sender& sender) {
  const Kept kept(work, slicer.box());
  print::Compensation compensation(
      work.printer, slicer.box(),
      [&] {
        const print::LayerPicture* const layer = slicer.next();
        if (layer != nullptr) add_totals(work.totals, *layer);
        return layer;
      },
      static_cast<int>(work.call.integer("iterations")), [&](std::size_t index) { return kept(index); });
  for (print::CompensatedLayer layer; compensation.next(layer);) {
    for (const auto& [sum, of] :
         {std::pair{&work.totals.before, &layer.before}, std::pair{&work.totals.after, &layer.after}})
      sum->sum_m2 += of->sum_m2, sum->voxels += of->voxels;
    kept.keep(layer);
    sender.add({layer.index, layer.bottom_m, layer.top_m, layer.box, std::move(layer.greys)});
  }
  sender.finish();
  kept.done();
}

}  // namespace

void send_bodies(Work& work) {
  const auto rays = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(work.call.integer("rays")))));
  print::Slicer slicer(work.printer, work.bodies, static_cast<int>(work.call.integer("samples")),
                       {.side = work.call.text("coverage") == "rays" ? rays : 0, .seed = work.call.seed});
  enter_bodies(work);
  Sender sender(work, slicer.layers());
  if (work.call.flag("compensate")) {
    compensate(work, slicer, sender);
  } else {
    print::GreyPicture greys(work.printer);
    while (const print::LayerPicture* const layer = slicer.next()) {
      add_totals(work.totals, *layer);
      sender.add({layer->index, layer->bottom_m, layer->top_m, layer->box, greys.of(*layer)});
    }
    sender.finish();
  }
  constexpr double overlaps = 1e-6, counts = 1e-3;
  if (work.totals.excess > overlaps)
    log(LogLevel::warning, format("bodies overlap: a voxel would be full %.3g times over", 1 + work.totals.excess));
  if (work.totals.unreached_m3 > counts * work.totals.solid_m3)
    log(LogLevel::warning, format("white grows %.4g um, a layer is %.4g um: %.2g %% of the volume stays empty",
                                  work.printer.growth.reach_m(work.printer.layer_m) * 1e6, work.printer.layer_m * 1e6,
                                  100 * work.totals.unreached_m3 / work.totals.solid_m3));
}

void send_sample(Work& work) {
  print::SampleWish wish;
  wish.slab_layers = static_cast<std::size_t>(work.call.integer("slab-layers"));
  wish.greys = static_cast<int>(work.call.integer("greys")),
  wish.repetitions = static_cast<int>(work.call.integer("repetitions"));
  work.sample = print::calibration_sample(work.printer, wish);
  Sender sender(work, work.sample->layers);
  double bottom_m = 0;
  const double pixel_m2 = work.printer.pixel_m.x * work.printer.pixel_m.y;
  for (std::size_t k = 0; k < work.sample->layers; ++k) {
    const std::vector<float> light = print::sample_layer(*work.sample, work.printer, k);
    const double layer_m = work.printer.thickness_m(k);
    Drawn drawn{k, bottom_m, bottom_m + layer_m, work.sample->slab, {}};
    drawn.greys.reserve(light.size());
    for (const float grey : light) {
      drawn.greys.push_back(static_cast<std::uint8_t>(std::lround(255 * grey)));
      work.totals.solid_m3 +=
          pixel_m2 * std::min(layer_m, work.printer.growth.height_m(static_cast<double>(grey), layer_m));
    }
    ++work.totals.layers, bottom_m += layer_m;
    sender.add(std::move(drawn));
  }
  sender.finish();
}

}  // namespace gonio::tools::dlp_slice
