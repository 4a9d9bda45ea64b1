#include "base/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

namespace gonio {
namespace {

class ProgressTest : public testing::Test {
 protected:
  ~ProgressTest() override {
    set_progress_mode(ProgressMode::automatic);
    set_log_level(LogLevel::warning);
    set_program_name("gonio");
  }
};

TEST_F(ProgressTest, MessagesBearTheProgramsNameAndObeyTheLevel) {
  set_program_name("render");
  set_log_level(LogLevel::info);
  testing::internal::CaptureStderr();
  log(LogLevel::info, "one");
  log(LogLevel::debug, "two");
  log(LogLevel::error, "three");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "render: one\nrender: three\n");
  set_log_level(LogLevel::quiet);
  testing::internal::CaptureStderr();
  log(LogLevel::error, "four");
  log(LogLevel::quiet, "five");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(ProgressTest, NoBarWhereStderrIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    Progress progress("rendering", 10);
    for (int i = 0; i < 10; ++i) progress.advance();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// The clock enters here only as "long enough for one drawing": a tenth of a second must have passed twice.
TEST_F(ProgressTest, ABarIsDrawnAndClearedAndLeavesMessagesWhole) {
  set_progress_mode(ProgressMode::always);
  testing::internal::CaptureStderr();
  {
    Progress progress("rendering", 4);
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    progress.advance(2);
    log(LogLevel::error, "a message");
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, testing::HasSubstr("rendering [###############...............] 50 %"));
  EXPECT_THAT(text, testing::HasSubstr("\r\x1b[Kgonio: a message\n"));
  EXPECT_TRUE(text.ends_with("\r\x1b[K"));
}

// A step that takes long is seen while it is taken.
TEST_F(ProgressTest, ALongStepOfSeveralIsDrawnAtOnce) {
  set_progress_mode(ProgressMode::always);
  testing::internal::CaptureStderr();
  { const Progress progress("weighing lens.radial", 4, 1); }
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "\r\x1b[Kweighing lens.radial [#######.......................] 25 %\r\x1b[K");
}

}  // namespace
}  // namespace gonio
