// Bodies that are fit to be made of glass: drawn from a family, or read from a file, and checked.
#pragma once
#include <cstdint>
#include <filesystem>

#include "glass/form.h"

namespace gonio::glass {

inline constexpr std::size_t most_triangles = 20000;

struct CheckedBody {
  Body body;
  std::size_t components = 0;
  std::int64_t genus = 0;  // of all surfaces together
  int draws = 1;           // until one was fit
};

// The bodies of a family by number; the same for the same (seed, number). What is open, crossed by itself or too fine
// is drawn anew, twenty times at most; then Error(internal).
CheckedBody drawn_body(const Form& form, std::uint64_t seed, std::uint64_t number);

// A mesh from a file (io/obj.h), whatever its unit: it is scaled. Decimated to `most_triangles`. Error(data) that says
// what is wrong with it, where it bounds no body.
CheckedBody body_in(const std::filesystem::path& path);

// Stood on z = 0 over the origin, its largest extent 1; the filling goes along.
void stand(Body& body);

}  // namespace gonio::glass
