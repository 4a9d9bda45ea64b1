// Recorded stacks: prove-stacks memorial|flea3|cat FOLDER, or prove-stacks manifest memorial|cat FOLDER > in.json,
// which writes what explain is asked (and the mask of memorial, here). Film scans of one scene taken as linear, whose
// tone curve is held against OpenCV's CalibrateDebevec on the same files; a raw sensor, which is linear; a glazed cat
// under twelve lamps whose directions the mirror ball beside it shows.
//
// A single run of CalibrateDebevec (300 random samples, lambda 50) differs from the mean of ten by 5 to 15 % at its
// worst code; the mean, of logarithms, is what stands for it here.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/photo.hpp>
#include <regex>

#include "data.h"
#include "explain/engine.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/photometric_problem.h"
#include "io/picture.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

namespace fs = std::filesystem;
using manifest::Value;

bool all_met = true;

void claim(const std::string& name, double measured, const char* sign, double required, bool met) {
  std::printf("%s: measured %.4g required %s %.4g%s\n", name.c_str(), measured, sign, required, met ? "" : " MISSED");
  all_met = all_met && met;
}

struct Found {
  std::unique_ptr<Problem> problem;
  Explanation e;
  std::string named;
};

// Where, how much it repairs on unseen groups, and what else ran.
void print_evidence(const Found& f) {
  const Explanation& e = f.e;
  if (!e.conditions.empty())
    std::printf("  located: %s, stage %s, between %.3g and %.3g %s\n", e.conditions[0].name.c_str(), e.stage.c_str(),
                e.conditions[0].lower, e.conditions[0].upper, e.conditions[0].unit.c_str());
  std::printf("  held out: %s %.4g -> %.4g\n", f.problem->score_name().c_str(), e.held_out_before, e.held_out_after);
  for (const Hypothesis& h : e.scoreboard) {
    std::printf("  %-44s held out %.4g, gain %.3g +- %.2g, %.2f %% of the signal, p %.1g", h.name.c_str(), h.held_out,
                h.gain, h.gain_sigma, 100 * h.effect, h.wald_p);
    for (std::size_t k = 0; k < std::min<std::size_t>(4, h.parameters.size()); ++k)
      std::printf(", %s %.3g(%.2g)", f.problem->parameters()[h.parameters[k].parameter].name.c_str(),
                  h.parameters[k].value, h.parameters[k].sigma);
    std::printf("%s%s\n", h.refused.empty() ? "" : "; ", h.refused.c_str());
  }
}

Found explained(std::unique_ptr<Problem> problem) {
  Found f;
  f.problem = std::move(problem);
  const Options options;
  f.e = explain(*f.problem, options);
  for (const std::size_t c : f.e.named) f.named += (f.named.empty() ? "" : " + ") + f.problem->candidates()[c].id();
  std::printf("%s\n", f.e.sentence.c_str());
  print_evidence(f);
  return f;
}

manifest::Document parsed(const Value& document, const fs::path& folder) {
  return manifest::parse_document(manifest::print_json(document), "recording.json", folder, {.allow_outside = true});
}

// Frame of `border` pixels that does not count.
void write_frame(const fs::path& path, int width, int height, int border) {
  io::Image mask(width, height, {"Y"});
  for (int y = border; y < height - border; ++y)
    for (int x = border; x < width - border; ++x) mask.at(x, y, 0) = 1;
  io::write_picture(path, mask);
}

constexpr int border = 30;  // blue where the scans were shifted
constexpr int draws = 10, samples = 300;

// Mean of the logarithms of the response that OpenCV finds, [channel R, G, B][code].
std::array<std::array<double, 256>, 3> debevec(const std::vector<cv::Mat>& pictures, const std::vector<float>& times) {
  std::array<std::array<double, 256>, 3> mean{};
  cv::setRNGSeed(1);
  for (int k = 0; k < draws; ++k) {
    cv::Mat response;
    cv::createCalibrateDebevec(samples, 50, true)->process(pictures, response, times);
    for (int code = 0; code < 256; ++code)
      for (int c = 0; c < 3; ++c)
        mean[static_cast<std::size_t>(2 - c)][static_cast<std::size_t>(code)] +=
            std::log(response.at<cv::Vec3f>(code)[c]) / draws;
  }
  return mean;
}

// The scans with their exposures; `scratch`: where the mask goes.
Value memorial_recording(const fs::path& folder, const fs::path& scratch) {
  write_frame(scratch / "mask.png", 512, 768, border);
  Value files = Value::object({{"mask", Value::object({{"path", "mask.png"}})}}), images = Value::array();
  std::ifstream list(folder / "list.txt");
  std::string file;
  for (double seconds = 0; list >> file >> seconds;) {
    files[file] = Value::object({{"path", (folder / file).string()}});
    images.push_back(Value::object(
        {{"id", file}, {"file", file}, {"exposure_s", seconds}, {"response", "linear"}, {"mask", "mask"}}));
  }
  return Value::object({{"gonio", 1}, {"files", files}, {"images", images}});
}

int memorial(const fs::path& folder) {
  const tests::ScratchFolder scratch;
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  std::ifstream list(folder / "list.txt");
  std::string file;
  for (double seconds = 0; list >> file >> seconds;) {
    const cv::Mat whole = cv::imread((folder / file).string());
    pictures.push_back(whole(cv::Rect(border, border, whole.cols - 2 * border, whole.rows - 2 * border)).clone());
    times.push_back(static_cast<float>(seconds));
  }
  const manifest::Document document = parsed(memorial_recording(folder, scratch.path()), scratch.path());
  const Found f = explained(std::move(exposures_problems(document).at(0)));
  claim("memorial: sensor.non-linearity alone is named", f.named == "sensor.non-linearity", "=", 1,
        f.named == "sensor.non-linearity");
  const bool curve = f.e.sentence.find("tone curve") != std::string::npos;
  claim("memorial: a tone curve, not a power law", curve, "=", 1, curve);
  claim("memorial: held-out relative RMSE, after over before", f.e.held_out_after / f.e.held_out_before, "<=", 0.15,
        f.e.held_out_after <= 0.15 * f.e.held_out_before);
  const ReadingChain chain = dynamic_cast<const ExposuresProblem&>(*f.problem).chain(f.e.values);
  const auto theirs = debevec(pictures, times);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> q;
    for (int code = 26; code <= 229; ++code)
      q.push_back(std::log(chain.response[c].light(code / 255.0 - chain.offset)) -
                  theirs[c][static_cast<std::size_t>(code)]);
    double mean = 0, square = 0, worst = 0;
    for (const double v : q) mean += v / static_cast<double>(q.size());
    for (const double v : q) {
      const double away = std::abs(std::exp(v - mean) - 1);
      square += away * away / static_cast<double>(q.size());
      worst = std::max(worst, away);
    }
    const std::string name =
        std::string("memorial: response against CalibrateDebevec, 10 to 90 % of the range, ") + "RGB"[c];
    claim(name + ", rms", std::sqrt(square), "<=", 0.1, std::sqrt(square) <= 0.1);
    claim(name + ", worst code", worst, "<=", 0.1, worst <= 0.1);
  }
  return all_met ? 0 : 1;
}

int flea3(const fs::path& folder) {
  std::map<std::string, Value> bands;
  std::map<std::string, Value> files;
  const std::regex name(".*_([0-9]+nm)_([0-9]+)ms_.*");
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder / "disks")) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) {
    std::smatch match;
    const std::string text = path.filename().string();
    if (!std::regex_match(text, match, name)) continue;
    Value &images = bands[match[1]], &own = files[match[1]];
    own[match[2].str()] = Value::object({{"path", path.string()}});
    images.push_back(Value::object({{"id", match[2].str()},
                                    {"file", match[2].str()},
                                    {"camera", "flea3"},
                                    {"exposure_s", std::stod(match[2]) / 1000},
                                    {"response", "linear"}}));
  }
  const Value camera = Value::object({{"model", "pinhole"},
                                      {"width_px", 408},
                                      {"height_px", 344},
                                      {"fx_px", 500},
                                      {"fy_px", 500},
                                      {"cx_px", 203.5},
                                      {"cy_px", 171.5},
                                      {"mosaic", "GBRG"}});
  int silent = 0;
  for (const auto& [band, images] : bands) {
    const manifest::Document document = parsed(Value::object({{"gonio", 1},
                                                              {"files", files[band]},
                                                              {"cameras", Value::object({{"flea3", camera}})},
                                                              {"images", images}}),
                                               folder);
    std::printf("%s: ", band.c_str());
    silent += explained(std::move(exposures_problems(document).at(0))).named.empty();
  }
  claim("flea3: bands of seven in which nothing is named", silent, "=", 7, silent == 7);
  return all_met ? 0 : 1;
}

// Direction of lamp i from the mirror sphere's highlight: the mirror of the view's direction about the normal there.
Vec3 towards_by_mirror(const fs::path& folder, std::size_t i) {
  const io::Image picture = io::read_picture(folder / "chrome" / ("chrome." + std::to_string(i) + ".png"));
  const io::Image mask = io::read_picture(folder / "chrome" / "chrome.mask.png");
  std::vector<double> level(picture.pixels());
  for (std::size_t p = 0; p < level.size(); ++p)
    if (mask.data[p * mask.channels.size()] > 0.5f)
      for (std::size_t c = 0; c < picture.channels.size(); ++c)
        level[p] += picture.data[p * picture.channels.size() + c];
  const double limit = 0.9 * *std::max_element(level.begin(), level.end());
  double x = 0, y = 0, n = 0;
  for (std::size_t p = 0; p < level.size(); ++p)
    if (level[p] > limit)
      x += static_cast<double>(p % static_cast<std::size_t>(picture.width)),
          y += static_cast<double>(p / static_cast<std::size_t>(picture.width)), n += 1;
  Vec3 normal{(x / n - 253.5) / 119.25, (y / n - 148.0) / 119.25, 0};
  normal.z = -std::sqrt(1 - dot(normal, normal));
  const Vec3 view{0, 0, -1};
  return normal * (2 * dot(normal, view)) - view;
}

Value cat_recording(const fs::path& folder) {
  Value files = Value::object({{"mask", Value::object({{"path", (folder / "cat/cat.mask.png").string()}})}});
  Value lights = Value::object(), images = Value::array();
  for (std::size_t i = 0; i < 12; ++i) {
    const std::string id = "cat-" + std::to_string(i), lamp = "lamp-" + std::to_string(i);
    const Vec3 l = towards_by_mirror(folder, i);
    files[id] = Value::object({{"path", (folder / "cat" / ("cat." + std::to_string(i) + ".png")).string()}});
    lights[lamp] = Value::object(
        {{"model", "directional"},
         {"towards", std::vector<double>{l.x, l.y, l.z}},
         {"watt_per_m2", Value::object({{"value", std::vector<double>{3, 3, 3}}, {"free", true}, {"min", 0}})}});
    images.push_back(
        Value::object({{"id", id}, {"file", id}, {"light", lamp}, {"response", "linear"}, {"mask", "mask"}}));
  }
  return Value::object({{"gonio", 1}, {"files", files}, {"lights", lights}, {"images", images}});
}

int cat(const fs::path& folder) {
  const manifest::Document document = parsed(cat_recording(folder), folder);
  const Found f = explained(std::move(photometric_problems(document).at(0)));
  const bool gloss = f.named.find("surface.interface") != std::string::npos;
  claim("cat: gloss is named", gloss, "=", 1, gloss);
  for (const Hypothesis& h : f.e.scoreboard)
    if (h.name == "surface.interface")
      std::printf("cat: surface.interface changes %.2f %% of the signal, gain %.3g +- %.3g, %s\n", 100 * h.effect,
                  h.gain, h.gain_sigma, h.refused.c_str());
  return all_met ? 0 : 1;
}

}  // namespace
}  // namespace gonio::explain::stacks

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  const bool written = argc == 4 && std::string(argv[1]) == "manifest";
  const std::string what = written ? argv[2] : argc == 3 ? argv[1] : "";
  try {
    if (written && (what == "memorial" || what == "cat")) {
      const fs::path folder = fs::absolute(argv[3]);
      std::cout << gonio::manifest::print_json(
          what == "cat" ? gonio::explain::stacks::cat_recording(folder)
                        : gonio::explain::stacks::memorial_recording(folder, fs::current_path()));
      return 0;
    }
    if (what == "memorial") return gonio::explain::stacks::memorial(fs::absolute(argv[2]));
    if (what == "flea3") return gonio::explain::stacks::flea3(fs::absolute(argv[2]));
    if (what == "cat") return gonio::explain::stacks::cat(fs::absolute(argv[2]));
  } catch (const std::exception& e) {
    std::cerr << "prove-stacks: " << e.what() << "\n";
    return 65;
  }
  std::cerr << "prove-stacks memorial|flea3|cat FOLDER\nprove-stacks manifest memorial|cat FOLDER\n";
  return 64;
}
