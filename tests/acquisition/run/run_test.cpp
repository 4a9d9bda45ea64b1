// Runs with faults: no frame bears a wrong label, none is lost in silence, and a run that was killed goes on.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "acquisition/plan/planner.h"
#include "acquisition/run/faulty_instrument.h"
#include "acquisition/run/frame_record.h"
#include "acquisition/run/journal.h"
#include "acquisition/run/runner.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

namespace fs = std::filesystem;
using testing::Book;
using testing::Faults;
using testing::faulty_instrument;

// A turntable, two lamps one at a time, a bracket each: steps * exposures frames.
manifest::Document turning(int steps, const std::vector<double>& exposures, const fs::path& folder) {
  manifest::Document d = manifest::parse_document(R"({"gonio": 1,
    "cameras": {"c": {"width_px": 24, "height_px": 16, "fx_px": 30, "fy_px": 30, "cx_px": 12, "cy_px": 8}},
    "lights": {"l1": {"model": "point", "position_m": [0, 0, 1], "watt_per_sr": [1, 1, 1]},
               "l2": {"model": "point", "position_m": [0, 1, 1], "watt_per_sr": [1, 1, 1]}},
    "laboratory": {"cameras": {"c": {"url": "sim://", "world_from_camera": {"translation_m": [0, 0, 1]}}},
                   "lamps": {"l1": {"url": "sim://"}, "l2": {"url": "sim://"}},
                   "turntables": {"t": {"url": "sim://"}}}})",
                                                  "lab.json", folder);
  manifest::Plan plan;
  plan.pattern = "turntable";
  for (int i = 0; i < steps; ++i) {
    manifest::PlanStep step;
    step.image = "v" + std::to_string(1000 + i);
    step.camera = "c";
    step.lamps = {i % 2 == 0 ? "l1" : "l2"};
    step.exposures_s = exposures;
    step.turntable_rad["t"] = 0.01 * i;
    plan.steps.push_back(step);
  }
  plan.id = plan_id(d, plan);
  d.plans.push_back(plan);
  return d;
}

Instrument instrument_of(const Faults& faults, std::uint64_t seed, const std::shared_ptr<Book>& book) {
  return faulty_instrument({"c"}, {"l1", "l2"}, {"t"}, faults, seed, book);
}

RunReport carry_out(manifest::Document& d, Instrument& instrument, const fs::path& out, bool resume = false) {
  const manifest::Plan plan = d.plans.front();
  RunOptions options;
  options.out = out;
  options.resume = resume;
  return run_plan(d, believed_laboratory(d), plan, instrument, options);
}

std::vector<std::uint16_t> codes_of(const fs::path& file) {
  const io::Image picture = io::read_picture(file);
  std::vector<std::uint16_t> codes;
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    codes.push_back(static_cast<std::uint16_t>(std::lround(picture.data[i * picture.channels.size()] * 65535.0F)));
  return codes;
}

int number_from(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

// Beside a turntable that has turned, a lamp is a light of its own at every step: "l1@v1007".
std::vector<std::string> lamps_of(const manifest::ImageEntry& image) {
  std::vector<std::string> lamps;
  for (const std::string& light : image.light) lamps.push_back(light.substr(0, light.find('@')));
  return lamps;
}

// GONIO_FRAMES=10000 for the whole of it. Each kind of fault strikes in 1 to 3 % of the frames.
TEST(Run, NoFrameBearsAWrongLabel) {
  const int steps = number_from("GONIO_FRAMES", 240) / 4;
  const tests::ScratchFolder folder;
  manifest::Document d = turning(steps, {0.002, 0.004, 0.008, 0.016}, folder.path());
  const auto book = std::make_shared<Book>();
  const Faults faults{.stuck_exposure = 0.03,
                      .late_chunk = 0.03,
                      .silent_late_chunk = 0.03,
                      .old_frame = 0.02,
                      .lost_packets = 0.02,
                      .no_frame = 0.02,
                      .dead_lamp = 0.03,
                      .lamp_forgets = 0.02};
  Instrument instrument = instrument_of(faults, 7, book);
  const RunReport report = carry_out(d, instrument, folder.path());
  int wrong = 0;
  for (const manifest::ImageEntry& image : d.images) {
    const auto truth = book->shown.find(codes_of(folder.path() / d.files.at(image.file).path));
    ASSERT_NE(truth, book->shown.end()) << image.id;
    const int step = std::stoi(image.group.substr(1)) - 1000;
    wrong += std::abs(truth->second.exposure_s - *image.exposure_s) > 1e-9 || truth->second.lamps != lamps_of(image) ||
             std::abs(truth->second.angle_rad - 0.01 * step) > 1e-9;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(static_cast<std::int64_t>(d.images.size()), report.frames);
  EXPECT_EQ(report.frames + report.refused, 4 * steps);  // none is lost in silence
  EXPECT_LE(report.refused, 4 * steps / 100);
  int struck = 0;
  for (const auto& [name, count] : book->injected) struck += count;
  EXPECT_EQ(book->injected.size(), 8U);
  EXPECT_GT(report.retaken, struck / 3);
  RecordProperty("retaken", static_cast<int>(report.retaken));
}

// A dead lamp hides in the light of the other: each is lit on its own first.
TEST(Run, OneDeadLampOfSeveralIsFound) {
  const int steps = 60;
  const tests::ScratchFolder folder;
  manifest::Document d = turning(steps, {0.002, 0.008}, folder.path());
  manifest::Plan& plan = d.plans.front();
  for (manifest::PlanStep& step : plan.steps) step.lamps = {"l1", "l2"};
  plan.id = plan_id(d, plan);
  const auto book = std::make_shared<Book>();
  Instrument instrument = instrument_of({.dead_lamp = 0.1}, 5, book);
  const RunReport report = carry_out(d, instrument, folder.path());
  for (const manifest::ImageEntry& image : d.images) {
    const auto truth = book->shown.find(codes_of(folder.path() / d.files.at(image.file).path));
    ASSERT_NE(truth, book->shown.end()) << image.id;
    EXPECT_EQ(truth->second.lamps, (std::vector<std::string>{"l1", "l2"})) << image.id;
    EXPECT_EQ(lamps_of(image), truth->second.lamps) << image.id;
  }
  EXPECT_EQ(report.frames, 2 * steps);  // five tries in a row: one step in 6000
  EXPECT_GT(book->injected["dead lamp"], 5);
}

TEST(Run, WithoutFaultsNothingIsTakenTwice) {
  const tests::ScratchFolder folder;
  manifest::Document d = turning(10, {0.002, 0.004, 0.008, 0.016}, folder.path());
  Instrument instrument = instrument_of({}, 3, std::make_shared<Book>());
  const RunReport report = carry_out(d, instrument, folder.path());
  EXPECT_EQ(report.frames, 40);
  EXPECT_EQ(report.retaken, 0);
  EXPECT_EQ(report.refused, 0);
  EXPECT_TRUE(report.words.empty()) << report.words.front();
}

// What a run enters into the manifest, without its times.
std::string entered(const manifest::Document& d) {
  std::string out;
  for (manifest::ImageEntry image : d.images) {
    out += image.id + " " + image.group + " " + std::to_string(*image.exposure_s) + " " + image.light.front() + " " +
           d.files.at(image.file).path + " " + d.files.at(image.file).sha256 + "\n";
  }
  return out;
}

// Runs in a process of its own that is killed after `frames` frames; true where it came to its end.
bool run_and_kill(const fs::path& folder, int steps, int frames, bool resume) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      manifest::Document d = turning(steps, {0.004, 0.008}, folder);
      const manifest::Plan plan = d.plans.front();
      Instrument instrument = instrument_of({}, testing::same_noise, std::make_shared<Book>());
      RunOptions options;
      options.out = folder;
      options.resume = resume;
      int kept = 0;
      options.on_frame = [&](const RunNews&) {
        if (++kept >= frames) ::raise(SIGKILL);
      };
      run_plan(d, believed_laboratory(d), plan, instrument, options);
      ::_exit(0);
    } catch (...) {
      ::_exit(3);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
  return WIFEXITED(status);
}

// GONIO_KILLS=200 for the whole of it.
TEST(Run, KilledAtAnyMomentItGoesOnAsIfItHadNot) {
  const int steps = 8;
  const tests::ScratchFolder whole;
  manifest::Document expected = turning(steps, {0.004, 0.008}, whole.path());
  Instrument instrument = instrument_of({}, testing::same_noise, std::make_shared<Book>());
  carry_out(expected, instrument, whole.path());
  Random random(11);
  for (int kills = 0, budget = number_from("GONIO_KILLS", 6); kills < budget;) {
    const tests::ScratchFolder folder;
    bool resume = false;
    while (!run_and_kill(folder.path(), steps, 1 + static_cast<int>(random.below(6)), resume)) {
      resume = true;
      ++kills;
      // A power cut: the journal's end is torn, a file that was written has no line.
      const fs::path journal = folder.path() / "journal.jsonl";
      if (random.uniform() < 0.5) fs::resize_file(journal, fs::file_size(journal) - random.below(120));
      if (random.uniform() < 0.2) write_file(folder.path() / "frames" / "v1007-2.png", "torn");
    }
    manifest::Document d = turning(steps, {0.004, 0.008}, folder.path());
    Instrument again = instrument_of({}, testing::same_noise, std::make_shared<Book>());
    const RunReport report = carry_out(d, again, folder.path(), true);
    EXPECT_EQ(report.frames, 2 * steps);
    EXPECT_EQ(entered(d), entered(expected));
  }
}

TEST(Run, AnotherPlansJournalIsRefused) {
  const tests::ScratchFolder folder;
  manifest::Document d = turning(2, {0.004}, folder.path());
  Instrument instrument = instrument_of({}, 3, std::make_shared<Book>());
  carry_out(d, instrument, folder.path());
  EXPECT_THROW(carry_out(d, instrument, folder.path()), Error);  // without resume
  manifest::Document other = turning(3, {0.004}, folder.path());
  try {
    carry_out(other, instrument, folder.path(), true);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_NE(std::string(e.what()).find("another plan"), std::string::npos) << e.what();
  }
}

TEST(Run, APlanThatWasChangedByHandIsRefused) {
  const tests::ScratchFolder folder;
  manifest::Document d = turning(2, {0.004}, folder.path());
  d.plans.front().steps.front().exposures_s = {0.008};
  Instrument instrument = instrument_of({}, 3, std::make_shared<Book>());
  EXPECT_THROW(carry_out(d, instrument, folder.path()), Error);
}

TEST(Journal, ATornEndIsCutOffAndNothingElse) {
  const tests::ScratchFolder folder;
  const fs::path path = folder.path() / "journal.jsonl";
  const manifest::Value head = manifest::Value::object({{"what", "run"}, {"plan", "p"}});
  {
    Journal journal(path, head, false);
    for (int i = 0; i < 5; ++i) journal.write(manifest::Value::object({{"what", "frame"}, {"n", i}}));
  }
  const std::string whole = read_file(path);
  for (std::size_t size = 0; size <= whole.size(); size += 7) {
    write_file(path, whole.substr(0, size));
    const auto complete =
        static_cast<std::size_t>(std::count(whole.begin(), whole.begin() + static_cast<long>(size), '\n'));
    const Journal journal(path, head, true);
    ASSERT_EQ(journal.earlier().size(), complete == 0 ? 0 : complete - 1) << size;
  }
  // A block that never reached the disk: zeros; and a line that was changed.
  std::string spoilt = whole;
  std::fill(spoilt.begin() + 200, spoilt.begin() + 210, '\0');
  EXPECT_LT(read_journal(spoilt).size(), 4U);
  spoilt = whole;
  const std::size_t three =
      spoilt.find("\"n\": 3") == std::string::npos ? spoilt.find("\"n\":3") : spoilt.find("\"n\": 3");
  ASSERT_NE(three, std::string::npos);
  spoilt[spoilt.find('3', three)] = '9';
  EXPECT_EQ(read_journal(spoilt).size(), 4U);  // head, 0, 1, 2
}

}  // namespace
}  // namespace gonio::acquisition
