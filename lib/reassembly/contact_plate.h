// Displacements of a thin plate under unilateral constraints, and the cheapest ones that meet such constraints.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "reassembly/contact_overlay.h"

namespace gonio::reassembly::contact {

// u, one a vertex of `shape` and zero where not free, that minimises the energy of a thin plate
//   1/2 integral (laplace u)^2 + u^2 / foundation^4     (cotangent weights, lumped areas)
// under all rows. The foundation holds a sheet that nothing else holds; far longer than what gives way, it is not felt.
// Rows may stay broken by `tolerance`.
std::vector<double> bent(const Layered& shape, const std::vector<std::uint8_t>& free, std::span<const Row> rows,
                         double foundation, double tolerance);

// Pushes vertices of broken rows down, all of a row's by what it lacks, until none is broken by more than `tolerance`.
// Nothing rises. Returns what would have to be free as well; empty: no row is broken. Nothing where it does not end.
std::optional<std::vector<std::uint32_t>> press(std::vector<double>& u, const std::vector<std::uint8_t>& free,
                                                std::span<const Row> rows, double tolerance, int most_rounds = 1000);

}  // namespace gonio::reassembly::contact
