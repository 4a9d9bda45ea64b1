// Where the manifest comes from when nobody names it: a pipe or a file on standard input, never a device, and never
// once the command line says what to work on, so that no program waits for a pipe that nobody writes to.
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

#include "base/atomic_file.h"
#include "data.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

// A pipe that is open and silent as long as this lives.
class IdlePipe {
 public:
  IdlePipe() {
    if (::pipe(ends_) != 0) throw std::runtime_error("no pipe");
  }
  ~IdlePipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  std::function<void()> as_standard_input() const {
    return [this] {
      ::dup2(ends_[0], 0);
      ::close(ends_[1]);
    };
  }

 private:
  int ends_[2];
};

// The exit status within ten seconds; 128 + 9 where the program still waits then.
Ended within_ten_seconds(const Process::Words& words, const std::filesystem::path& folder,
                         const std::function<void()>& before) {
  Process process(words, folder, {}, before);
  std::atomic<bool> ended{false};
  std::thread watch([&] {
    for (int i = 0; i < 100 && !ended; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (!ended) ::kill(process.id(), SIGKILL);
  });
  Ended result = process.end();
  ended = true;
  watch.join();
  return result;
}

TEST(StandardInput, NoProgramWaitsOnceItKnowsWhatToWorkOn) {
  const ScratchFolder folder;
  const IdlePipe pipe;
  write_file(folder / "empty.json", R"({"gonio": 1})");
  const std::vector<Process::Words> calls = {
      {"vdi2634", "absent.ply"},
      {"calib-charuco", "--checkerboard", "9x6", "--square", "25mm", "absent.png"},
      {"compare", "--reference", "absent.exr", "--rendered", "absent.exr"},
      {"render", "--specimen", "board", "--out", "s"},
      {"explain", "--list"},
      {"develop", "--undistort", "--out", "d", "-i", "empty.json"},
      {"camera-export", "--to", "ros", "empty.json"},
      {"render", "--help"},
  };
  for (const auto& words : calls)
    EXPECT_LT(within_ten_seconds(words, folder.path(), pipe.as_standard_input()).status, 128) << words[0];
}

TEST(StandardInput, APipeThatIsWrittenToIsRead) {
  const ScratchFolder folder;
  write_file(folder / "empty.json", R"({"gonio": 1})");
  const std::string bin = GONIO_BIN;
  const Ended ended =
      run({"bash", "-c", "(sleep 0.3; cat empty.json) | " + bin + "/camera-export --to ros"}, folder.path());
  EXPECT_EQ(ended.status, 65);  // it was read: it has no cameras
  EXPECT_THAT(ended.err, HasSubstr("standard input#/cameras"));
  EXPECT_THAT(run({"bash", "-c", bin + "/camera-export --to ros < empty.json"}, folder.path()).err,
              HasSubstr("standard input#/cameras"));
}

TEST(StandardInput, DevicesAndClosedDescriptorsAreNoManifest) {
  const ScratchFolder folder;
  const std::string call = std::string(GONIO_BIN) + "/camera-export --to ros";
  for (const char* input : {" < /dev/null", " < /dev/zero", " <&-", " < <(true)"})
    EXPECT_EQ(run({"bash", "-c", call + input}, folder.path()).status, 66) << input;
}

TEST(StandardInput, AManifestNamedAsOperandLeavesNoOperand) {
  const ScratchFolder folder;
  write_file(folder / "empty.json", R"({"gonio": 1})");
  const Ended ended = run({"develop", "--undistort", "--out", "d", "empty.json"}, folder.path());
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("has no image with a file"));
}

}  // namespace
}  // namespace gonio::tests
