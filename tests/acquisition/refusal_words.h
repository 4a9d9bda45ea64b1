// What a refusal says: for tests of devices.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "base/error.h"

namespace gonio::tests {

// The one line of the Error that `work` throws, whose exit is `code`.
template <class Work>
std::string words_of(const Work& work, Exit code) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace gonio::tests
