// See laboratory_run.h. The manifest goes from program to program as through pipes.
#include "sealed/laboratory/laboratory_run.h"

#include <chrono>

#include "base/atomic_file.h"
#include "base/text.h"
#include "process.h"

namespace gonio::sealed {
namespace {

using Words = tests::Process::Words;

struct Link {
  Words words;
  int worst = 0;  // exit status up to which its manifest counts
};

}  // namespace

std::string run_laboratory(const LaboratoryCase& sealed, int spp, const std::filesystem::path& folder,
                           const std::filesystem::path& truths, const std::vector<std::string>& hypotheses) {
  const auto begun = std::chrono::steady_clock::now();
  const std::filesystem::path truth = std::filesystem::absolute(truths) / (folder.filename().string() + ".json");
  make_folder(truths);
  write_file(folder / "lab.json", manifest::print_document(sealed.believed, folder));
  write_file(truth, manifest::print_document(sealed.truth, truths));
  Words plan{"acquire", "-i", "lab.json"};
  plan.insert(plan.end(), sealed.plan.begin(), sealed.plan.end());
  const std::string seed = std::to_string(sealed.seed), quiet = "error";
  // Views out of reach leave 2 behind, and so does a calibration whose gates something real has shut.
  Words explain{"explain", "--threads", "1", "--out", "out"};
  for (const std::string& one : hypotheses) explain.insert(explain.end(), {"--hypotheses", one});
  const std::vector<Link> chain{
      {plan, 2},
      {{"acquire", "--go", "--truth", truth.string(), "--spp", std::to_string(spp), "--seed", seed, "--out", "run"}, 2},
      {{"calib-charuco", "--model", "pinhole", "--charuco", "9x7", "--square", "20mm", "--marker", "15mm",
        "--dictionary", "4X4_50", "--out", "calibrated"},
       2},
      {{"handeye"}, 2},
      {explain, 2}};
  std::string manifest;
  int status = 0;
  for (const Link& link : chain) {
    Words words = link.words;
    words.insert(words.end(), {"--log-level", quiet});
    const tests::Ended ended = tests::run(words, folder, manifest);
    status = ended.status;
    if (status < 0 || status > link.worst) {
      write_file(folder / "stderr.txt", ended.err);
      return words.front() + " left with " + std::to_string(status) + ": " + ended.err;
    }
    manifest = ended.out;
  }
  write_file(folder / "out.json", manifest);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  write_file(folder / "status.txt", format("%d %.1f\n", status, took.count()));
  return {};
}

}  // namespace gonio::sealed
