#include "base/loaded_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace gonio {
namespace {

Error refusal(const char* library, const char* name) {
  try {
    function_in(library, name, "install it");
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << library << " has " << name;
  return Error(Exit::done, "", "");
}

TEST(LoadedLibrary, AFunctionIsFoundByItsName) {
  decltype(&::strtol) parsed = nullptr;
  load(parsed, "libc.so.6", "strtol", "install it");
  EXPECT_EQ(parsed("2f", nullptr, 16), 47);
}

TEST(LoadedLibrary, WhatIsMissingIsNamedWithTheRemedy) {
  const Error no_library = refusal("libgonio_has_no_such.so.3", "f");
  EXPECT_EQ(no_library.code(), Exit::internal);
  EXPECT_EQ(no_library.place(), "libgonio_has_no_such.so.3");
  EXPECT_EQ(no_library.remedy(), "install it");
  const Error no_function = refusal("libc.so.6", "gonio_has_no_such");
  EXPECT_EQ(no_function.code(), Exit::internal);
  EXPECT_THAT(no_function.what(), testing::HasSubstr("gonio_has_no_such"));
}

TEST(LoadedLibrary, AModuleThatIsMissingIsNamedAsItsFile) {
  try {
    loaded_from_module<void()>("no_such", "f");
    FAIL() << "there is such a module";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::internal);
    EXPECT_THAT(e.place(), testing::EndsWith("gonio_no_such.so"));
    EXPECT_THAT(e.remedy(), testing::HasSubstr("lib/gonio"));
  }
}

}  // namespace
}  // namespace gonio
