// See alignment_page.h.
#include "alignment/alignment_page.h"

#include <algorithm>
#include <cmath>

#include "alignment/alignment_entry.h"
#include "alignment/convergence.h"
#include "alignment/overlay.h"
#include "alignment/region_difference.h"
#include "base/error.h"
#include "base/text.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "report/number_text.h"
#include "report/page.h"
#include "stats/intervals.h"

namespace gonio::alignment {
namespace {

// The photograph as people look at it: its 99th percentile white, sRGB's curve for linear ones. Empty where it has
// none.
io::Image shown(const manifest::Document& document, const std::string& id) {
  const std::size_t i = *manifest::index_of_image(document, id);
  io::Image picture;
  try {
    picture = io::read_picture(manifest::picture_path(document, i));
  } catch (const Error&) {
    return {};
  }
  const bool colour = picture.channel("R") >= 0;
  io::Image out(picture.width, picture.height,
                colour ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
  const bool linear = manifest::picture_path(document, i).extension() == ".exr";
  const auto step = picture.channels.size(), channels = out.channels.size();
  std::vector<double> values;
  for (std::size_t p = 0; p < picture.pixels(); p += 7) values.push_back(picture.data[p * step]);
  const auto white = static_cast<float>(std::max(1e-12, stats::quantile(values, 0.99)));
  for (std::size_t p = 0; p < picture.pixels(); ++p)
    for (std::size_t c = 0; c < channels; ++c) {
      const float v = picture.data[p * step + std::min(c, step - 1)];
      out.data[p * channels + c] = linear ? io::srgb_from_linear(std::clamp(v / white, 0.0F, 1.0F)) : v;
    }
  return out;
}

// Of those that were found together.
const Fitted& shared_fit(const std::vector<Aligned>& all) {
  for (const Aligned& a : all)
    if (a.stands()) return a.fitted;
  return all.front().fitted;
}

std::string with_sigma(double value, double sigma, double unit) {
  return report::with_sigma(unit * value, unit * sigma);
}

report::TableText pose_table(const AlignmentInput& in, const std::vector<Aligned>& all) {
  report::TableText t{.caption = "What was found, with one standard deviation.",
                      .columns = {{"What", "", false}, {"x"}, {"y"}, {"z"}, {"Unit", "", false}},
                      .rows = {}};
  Eigen::Index at = 0;
  const Fitted& f = shared_fit(all);
  for (const Freedom& free : in.question.freedoms) {
    std::vector<std::string> row;
    const auto sigma = [&](std::size_t k) {
      const Eigen::Index i = at + static_cast<Eigen::Index>(k);
      return std::sqrt(std::max(0.0, f.covariance(i, i)));
    };
    const auto three = [&](const std::string& name, Vec3 v, double unit, const char* unit_name) {
      row = {name, with_sigma(v.x, sigma(0), unit), with_sigma(v.y, sigma(1), unit), with_sigma(v.z, sigma(2), unit),
             unit_name};
    };
    if (free.block == Block::body_shift)
      three("middle of " + in.bodies[free.which], f.setting.bodies[free.which].centre_m(), 1e3, "mm");
    if (free.block == Block::body_turn)
      three("turn of " + in.bodies[free.which] + " from its mesh's axes",
            rotation_vector_of(f.setting.bodies[free.which].world_from_object.rotation), 180 / pi, "degrees");
    if (free.block == Block::lamp_shift)
      three("lamp " + in.lamp_words(free.which), f.setting.lamps_m[free.which], 1e3, "mm");
    if (free.block == Block::station_shift)
      three("camera of " + in.images_of_station[free.which].front(),
            f.setting.stations[free.which].world_from_camera.translation_m, 1e3, "mm");
    if (free.block == Block::body_scale) {
      const Vec3 s = f.setting.bodies[free.which].scale - Vec3{1, 1, 1};
      row = {"growth of " + in.bodies[free.which], with_sigma(s.x, sigma(0), 100),
             free.uniform ? "" : with_sigma(s.y, sigma(1), 100), free.uniform ? "" : with_sigma(s.z, sigma(2), 100),
             "%"};
    }
    if (free.block == Block::lens_focal) {
      const Lens& lens = f.setting.lenses[free.which];
      row = {"focal lengths of " + in.cameras[free.which], with_sigma(lens.fx_px, lens.fx_px * sigma(0), 1),
             with_sigma(lens.fy_px, lens.fy_px * sigma(0), 1), "", "px"};
    }
    if (free.block == Block::ground_tilt || free.block == Block::ground_shift) {
      const std::vector<double> by = change_between(in.stated, f.setting, {free});
      row = free.block == Block::ground_shift
                ? std::vector<std::string>{"rise of " + in.ground, "", "", with_sigma(by[0], sigma(0), 1e3), "mm"}
                : std::vector<std::string>{"tilt of " + in.ground + " about its tangents",
                                           with_sigma(by[0], sigma(0), 180 / pi), with_sigma(by[1], sigma(1), 180 / pi),
                                           "", "degrees"};
    }
    if (!row.empty()) t.rows.push_back(row);
    at += static_cast<Eigen::Index>(free.size());
  }
  return t;
}

report::TableText rim_table(const manifest::Document& document, const AlignmentInput& in, const Fitted& f) {
  report::TableText t{
      .caption =
          "Rims. Offsets are of the seen points from the model's rim, along its normal; the mean is positive outside.",
      .columns = {{"Picture", "", false},
                  {"Rim", "", false},
                  {"Points"},
                  {"Left out"},
                  {"rms", "px"},
                  {"Mean", "px"},
                  {"Seen of the model's", "%"}},
      .rows = {}};
  for (std::size_t k = 0; k < in.rims.size() && k < f.sightings.size(); ++k) {
    const SightingFit& s = f.sightings[k];
    const manifest::Outline& o = document.outlines[in.rims[k].outline];
    t.rows.push_back({o.image, o.kind + (o.kind == "shadow" ? " of " : " ") + o.object,
                      std::to_string(s.counted + s.left_out), std::to_string(s.left_out),
                      report::number_text(s.rms_px, 3), report::number_text(s.mean_px, 2),
                      report::number_text(100 * s.explained, 3)});
  }
  return t;
}

report::Plot offsets_plot(const AlignmentInput& in, const Fitted& f) {
  report::Plot plot{.title = "Offsets along the rims",
                    .caption = "Of what counts; noise has no pattern here, a wrong shape has.",
                    .x_label = "place along the rims / px",
                    .y_label = "offset / px"};
  report::Series object{.kind = report::Series::Kind::points, .name = "objects"},
      shadow{.kind = report::Series::Kind::points, .name = "shadows"};
  double start = 0;
  for (std::size_t k = 0; k < f.sightings.size(); ++k) {
    const Sighting& seen = in.question.sightings[k];
    report::Series& to = seen.subject.lamp ? shadow : object;
    double far = 0;
    const std::size_t step = 1 + seen.points.size() / 400;
    for (std::size_t i = 0; i < seen.points.size(); i += step)
      if (f.sightings[k].weight[i] > 0.1)
        to.x.push_back(start + static_cast<double>(i)), to.y.push_back(f.sightings[k].offset_px[i]),
            far = static_cast<double>(i);
    start += far + 20;
  }
  plot.series = {object, shadow};
  return plot;
}

std::string headline(const AlignmentInput& in, const std::vector<Aligned>& all) {
  std::string text;
  for (std::size_t b = 0; b < all.size(); ++b)
    text += (b > 0 ? "; " : "") + in.bodies[b] + ": " + word_of(all[b].verdict) +
            (all[b].why.empty() ? "" : ", " + all[b].why);
  return text;
}

struct Photograph {
  std::string image;
  std::vector<std::size_t> rims;
};
// The first 16 that show rims.
std::vector<Photograph> photographs(const AlignmentInput& in, const Fitted& f) {
  std::vector<Photograph> out;
  for (std::size_t k = 0; k < in.rims.size() && k < f.sightings.size(); ++k) {
    const auto known =
        std::find_if(out.begin(), out.end(), [&](const Photograph& p) { return p.image == in.rims[k].image; });
    if (known != out.end())
      known->rims.push_back(k);
    else if (out.size() < 16)
      out.push_back({in.rims[k].image, {k}});
  }
  return out;
}

void show_rims(report::Page& page, const manifest::Document& document, const AlignmentInput& in, const Fitted& f) {
  page.section("Pictures");
  std::vector<report::Figure> figures;
  for (const Photograph& p : photographs(in, f))
    figures.push_back(
        {.svg = overlay_svg(in, f.setting, p.rims, f.sightings, shown(document, p.image)),
         .title = p.image,
         .caption = "The model's rims: object blue, shadow orange; red: seen points that count for nothing."});
  page.figures(figures, 520);
}

void show_differences(report::Page& page, const manifest::Document& document, const AlignmentInput& in,
                      const Fitted& f) {
  page.section("Before and after");
  page.paragraph(
      "The model's regions against the masks. Blue: pixels of a mask that the model does not cover; red: pixels that "
      "the model covers outside of its mask; grey: both agree; palest grey: hidden, or nobody can tell.");
  for (const Photograph& p : photographs(in, f)) {
    const auto two = region_differences(in, p.rims, read_regions(document, p.image, {}), {in.stated, f.setting});
    std::vector<report::Figure> pair;
    for (std::size_t k = 0; k < two.size(); ++k)
      pair.push_back({.png = io::encode_png(two[k].picture),
                      .title = p.image + (k == 0 ? ", as stated" : ", as the fit ended"),
                      .caption = words_of(two[k])});
    page.figures(pair, 480);
  }
}

// What the pictures themselves say, where they were asked.
void show_pictures(report::Page& page, const PictureAnswer& a) {
  page.section("By the pictures");
  page.paragraph("Rims and pictures together: " + words_of(a) + ".");
  if (!a.taken)
    page.paragraph(
        "All that stands on this page is the rims' answer. That of rims and pictures is in the manifest, "
        "alignments/pictures.");
  page.key_numbers(
      {{"rims move", report::number_text(a.move_px, 2), "px", format("of %.3f px that they state", a.sigma_px)},
       {"chi-square of the move", report::number_text(a.chi2, 3), "",
        format("of %zu numbers, limit %.1f", a.numbers, a.chi2_limit)},
       {"pixels", std::to_string(a.pixels), "", format("worth %.0f independent values", a.independent)},
       {"errors are alike over", report::number_text(a.correlation_px, 2), "px", "side of a square"}});
  report::TableText t{.caption = "Root mean square of what is left, over that of what is seen.",
                      .columns = {{"Picture", "", false}, {"At the rims' answer", "%"}, {"With the pictures", "%"}},
                      .rows = {}};
  for (const PictureAnswer::Photograph& p : a.each)
    t.rows.push_back({p.image, report::number_text(100 * p.before, 3), report::number_text(100 * p.after, 3)});
  page.table(t);
}

void show_convergence(report::Page& page, const AlignmentInput& in, const std::vector<Aligned>& all) {
  page.section("Convergence");
  std::vector<report::Plot> plots;
  for (std::size_t b = 0; b < all.size(); ++b) plots.push_back(convergence_plot(in.bodies[b], all[b].tried));
  page.plots(plots);
  for (std::size_t b = 0; b < all.size(); ++b) page.table(table_of_starts(in.bodies[b], all[b].tried));
}

}  // namespace

std::string alignment_page(const manifest::Document& document, const AlignmentInput& in,
                           const std::vector<Aligned>& all) {
  const Fitted& f = shared_fit(all);
  const bool good = std::all_of(all.begin(), all.end(), [](const Aligned& a) { return a.verdict == Verdict::found; });
  report::Page page("align", headline(in, all),
                    format("%zu rims from %zu places, by their normal offsets from the mesh's own rims", in.rims.size(),
                           in.images_of_station.size()),
                    good ? report::Tone::good : report::Tone::bad);
  page.key_numbers({{"rms offset", report::number_text(f.rms_px, 3), "px", "of points that count"},
                    {"one error is alike over", report::number_text(f.correlation_px, 2), "px", "of rim"},
                    {"seen of the model's rims", report::number_text(100 * f.explained, 3), "%", ""}});
  show_rims(page, document, in, f);
  page.section("Found");
  page.table(pose_table(in, all));
  for (const Aligned& a : all) {
    std::vector<std::string> open = a.open;
    open.insert(open.end(), a.symmetries.begin(), a.symmetries.end());
    if (!open.empty()) page.paragraph("No rim holds, or looks alike:"), page.list(open);
  }
  for (const std::size_t lamp : loose_lamps(in, f))
    page.paragraph("No rim holds the place of lamp " + in.lamp_words(lamp) + ".");
  for (const Aligned& a : all)
    if (a.pictures) {
      show_pictures(page, *a.pictures);
      break;
    }
  show_differences(page, document, in, f);
  show_convergence(page, in, all);
  page.section("What is left");
  page.table(rim_table(document, in, f));
  page.plot(offsets_plot(in, f));
  return page.html();
}

}  // namespace gonio::alignment
