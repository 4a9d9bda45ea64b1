// See run_page.h.
#include "acquisition/run/run_page.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

constexpr int reload_s = 5, shown_px = 640;
constexpr double most_gain = 50;

const FrameRecord* last_of(const std::map<std::string, FrameRecord>& records) {
  const FrameRecord* last = nullptr;
  for (const auto& [image, record] : records)
    if (last == nullptr || record.time_s > last->time_s) last = &record;
  return last;
}

std::string duration_text(double s) {
  return s < 90 ? format("%.0f s", s) : s < 5400 ? format("%.0f min", s / 60) : format("%.1f h", s / 3600);
}

report::TableText frames_table(const manifest::Plan& plan, const std::map<std::string, FrameRecord>& records) {
  report::TableText table;
  table.columns = {{"frame", "", false}, {"camera", "", false},     {"lamps", "", false}, {"exposure", "ms"},
                   {"mean code", ""},    {"saturated pixels", "%"}, {"tries", ""}};
  for (const manifest::PlanStep& step : plan.steps)
    for (const std::string& image : images_of(step)) {
      const auto at = records.find(image);
      if (at == records.end()) continue;
      const FrameRecord& r = at->second;
      std::string lamps;
      for (const std::string& lamp : r.lamps) lamps += (lamps.empty() ? "" : ", ") + lamp;
      table.rows.push_back({image, r.camera, lamps, format("%.4g", 1e3 * r.exposure_s),
                            format("%.0f", r.figures.mean_code), format("%.2g", 100 * r.figures.saturated_share),
                            std::to_string(r.tries)});
    }
  return table;
}

}  // namespace

std::string shown_frame(const std::filesystem::path& path, int widest) {
  const io::Image frame = io::read_picture(path);
  const int square = std::max(1, (frame.width + widest - 1) / widest);
  const int channels = static_cast<int>(frame.channels.size());
  io::Image shown(std::max(1, frame.width / square), std::max(1, frame.height / square), {"Y"});
  for (int y = 0; y < shown.height; ++y)
    for (int x = 0; x < shown.width; ++x) {
      double sum = 0;
      for (int j = 0; j < square; ++j)
        for (int i = 0; i < square; ++i)
          for (int c = 0; c < channels; ++c) sum += double{frame.at(x * square + i, y * square + j, c)};
      shown.at(x, y, 0) = static_cast<float>(sum / (square * square * channels));
    }
  std::vector<float> sorted = shown.data;
  const auto bright = sorted.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, bright);
  const auto gain = static_cast<float>(std::clamp(0.9 / std::max(1e-9, double{*bright}), 1.0, most_gain));
  for (float& v : shown.data) v = io::srgb_from_linear(std::min(1.0f, gain * v));
  return io::encode_png(shown);
}

RunPage::RunPage(const manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                 std::filesystem::path out)
    : document_(document),
      laboratory_(laboratory),
      plan_(plan),
      out_(std::move(out)),
      drawing_(drawing_of(document, laboratory, plan)) {
  for (const manifest::PlanStep& step : plan.steps) total_ += images_of(step).size();
}

std::string RunPage::html(const RunState& state) const {
  const auto& records = *state.records;
  const FrameRecord* last = last_of(records);
  const bool whole = records.size() == total_ && state.stopped.empty();
  const std::string headline =
      format("%zu of %zu frames", records.size(), total_) + (state.running           ? ", running"
                                                             : state.stopped.empty() ? ""
                                                                                     : ", stopped");
  report::Page page(
      "A run", headline,
      state.stopped.empty() ? "Plan " + plan_.id.substr(0, 12) + ": " + plan_.pattern + "." : state.stopped,
      state.running                 ? report::Tone::neutral
      : whole && state.refused == 0 ? report::Tone::good
                                    : report::Tone::bad);
  if (state.running) page.reload_every(reload_s);
  std::vector<report::KeyNumber> numbers{{"frames", std::to_string(records.size()), "of " + std::to_string(total_), ""},
                                         {"taken again", std::to_string(state.retaken), "", ""},
                                         {"refused", std::to_string(state.refused), "", "",
                                          state.refused > 0 ? report::Tone::bad : report::Tone::neutral}};
  if (state.running && state.left_s) numbers.push_back({"to go", duration_text(*state.left_s), "", ""});
  page.key_numbers(numbers);
  std::set<std::size_t> taken;
  double at_s = 0;
  for (std::size_t k = 0; k < plan_.steps.size(); ++k) {
    const auto images = images_of(plan_.steps[k]);
    if (std::ranges::all_of(images, [&](const auto& id) { return records.contains(id); })) taken.insert(k);
    if (last != nullptr && last->group == plan_.steps[k].image) at_s = drawing_.times.stands[k].from_s;
  }
  if (last != nullptr) {
    page.section("The last picture");
    report::Figure picture;
    picture.png = shown_frame(out_ / last->file, shown_px);
    picture.title = last->image;
    picture.caption = words_of(*last) + ". Brightened for the eye.";
    page.figures({picture}, shown_px);
  }
  page.section("The laboratory");
  show_model(page, plan_model(document_, laboratory_, plan_, drawing_.times, &taken).model, at_s,
             last == nullptr ? "At home." : "As it stood for the last picture; the slider leads through the plan.");
  page.section("Over time");
  show_over_time(page, drawing_);
  list_unreachable(page, plan_);
  if (!state.words.empty()) {
    page.section("Refused or doubtful");
    page.list(state.words);
  }
  if (!records.empty()) {
    page.section("Frames");
    page.open_details(format("All %zu", records.size()));
    page.table(frames_table(plan_, records));
    page.close_details();
  }
  page.footer("Plan " + plan_.id);
  return page.html();
}

}  // namespace gonio::acquisition
