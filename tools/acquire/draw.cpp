// acquire --picture, --html, --gltf: the laboratory and the plan drawn, and the page of a run while it goes on.
#include <chrono>
#include <filesystem>
#include <fstream>

#include "acquisition/plan/plan_page.h"
#include "acquisition/run/run_page.h"
#include "base/atomic_file.h"
#include "base/progress.h"
#include "scene/exchange/moving_gltf.h"
#include "tools/acquire/call.h"

namespace gonio::tools::acquire {
namespace {

using namespace gonio::acquisition;

constexpr double seconds_between_pages = 3;

bool ends_in(const std::string& text, std::string_view ending) {
  return text.size() > ending.size() && text.ends_with(ending);
}

// After a signal write_file() refuses; a page that loads itself anew and says "running" for ever must not stay.
void write_after_signal(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::path whole = file;
  whole += ".stopped";
  std::ofstream(whole, std::ios::binary) << text;
  if (std::filesystem::file_size(whole) == text.size())
    std::filesystem::rename(whole, file);
  else
    std::filesystem::remove(whole);
}

}  // namespace

void check_drawings(const cli::Invocation& call) {
  if (!call.given("gltf")) return;
  const std::string file = call.text("gltf");
  if (!ends_in(file, ".gltf") && !ends_in(file, ".glb"))
    throw Error(Exit::usage, "--gltf", "\"" + file + "\" ends in neither .gltf nor .glb",
                "end it in .glb, or in .gltf for text");
}

void draw(const cli::Invocation& call, const Laboratory& laboratory, const manifest::Plan* plan) {
  if (call.given("picture")) write_file(call.text("picture"), laboratory_page(call.document, laboratory));
  if (call.given("html") && plan != nullptr) write_file(call.text("html"), plan_page(call.document, laboratory, *plan));
  if (!call.given("gltf")) return;
  const LaboratoryModel shown =
      plan == nullptr ? laboratory_model(call.document, laboratory)
                      : plan_model(call.document, laboratory, *plan, times_of(call.document, laboratory, *plan));
  write_file(call.text("gltf"), scene::gltf_of(shown.model, ends_in(call.text("gltf"), ".glb")));
}

struct LivePage::Parts {
  using Clock = std::chrono::steady_clock;
  std::string file;
  RunPage page;
  std::map<std::string, FrameRecord> records;  // what a run that stops leaves behind
  std::int64_t retaken = 0, refused = 0;
  std::vector<std::string> words;
  std::size_t kept = 0;  // by this run
  Clock::time_point began = Clock::now(), written{};

  void write(const RunState& state) const { write_file(file, page.html(state)); }
};

LivePage::LivePage(const cli::Invocation& call, const Laboratory& laboratory, const manifest::Plan& plan) {
  if (call.given("html"))
    parts_.reset(new Parts{call.text("html"), RunPage(call.document, laboratory, plan, call.out), {}, 0, 0, {}});
}

LivePage::~LivePage() = default;

void LivePage::show(const RunNews& news) {
  if (!parts_) return;
  const auto now = Parts::Clock::now();
  if (++parts_->kept == 1)
    parts_->records = news.records;
  else
    parts_->records.insert_or_assign(news.frame.image, news.frame);
  parts_->retaken = news.report.retaken, parts_->refused = news.report.refused, parts_->words = news.report.words;
  if (parts_->kept > 1 && std::chrono::duration<double>(now - parts_->written).count() < seconds_between_pages) return;
  RunState state{.records = &news.records,
                 .retaken = news.report.retaken,
                 .refused = news.report.refused,
                 .words = news.report.words};
  const double gone = std::chrono::duration<double>(now - parts_->began).count();
  state.left_s = gone / static_cast<double>(parts_->kept) * static_cast<double>(news.total - news.records.size());
  parts_->write(state);
  parts_->written = now;
}

void LivePage::finish(const RunReport& report) {
  if (!parts_) return;
  parts_->write({.records = &report.records,
                 .retaken = report.retaken,
                 .refused = report.refused,
                 .words = report.words,
                 .running = false,
                 .stopped = report.stopped});
}

// What stopped the run is what the user has to hear: whatever goes wrong here is left at that.
void LivePage::stop(const std::string& why) {
  if (!parts_ || !std::filesystem::is_regular_file(parts_->file)) return;
  try {
    write_after_signal(parts_->file, parts_->page.html({.records = &parts_->records,
                                                        .retaken = parts_->retaken,
                                                        .refused = parts_->refused,
                                                        .words = parts_->words,
                                                        .running = false,
                                                        .stopped = why}));
  } catch (const std::exception& error) {
    log(LogLevel::debug, parts_->file + ": " + error.what());
  }
}

}  // namespace gonio::tools::acquire
