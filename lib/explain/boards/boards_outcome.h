// What surrounds the boards problem: its parameters, the conditions of a corner, the upgraded cameras and boards, the
// pictures. Private to boards/.
#pragma once
#include <string>
#include <vector>

#include "explain/boards/boards_problem.h"
#include "explain/domain.h"
#include "inference/explanation.h"

namespace gonio::explain {

// What a parameter of the problem moves: a column of camera::CornerColumn of one camera, board or view; the others are
// none. A pose belongs to the first of the views that share it.
struct BoardRole {
  std::size_t camera = static_cast<std::size_t>(-1), board = static_cast<std::size_t>(-1),
              view = static_cast<std::size_t>(-1);
  std::size_t column = 0;
  std::size_t corner = static_cast<std::size_t>(-1);  // of the board's places
};

// Family of the candidates that say where a board's corners stand.
inline constexpr const char* the_boards_shape = "the board's shape";

struct BoardParameters {
  std::vector<Parameter> parameters;
  std::vector<BoardRole> roles;
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
};
BoardParameters board_parameters(const BoardsInput& input);

// The forward model of one view under `values`, and the turn of its pose from where it started.
struct BoardScene {
  camera::CornerModel model;
  Vec3 turn;
  std::vector<std::array<double, 3>> print_m{};  // of the board's places; empty: none stands beside
  // The model as one corner needs it.
  const camera::CornerModel& of(const BoardsInput::Corner& corner);
};
BoardScene board_scene(const BoardsInput& input, const std::vector<BoardRole>& roles, std::span<const double> values,
                       std::size_t view);

// Conditions of all corners, two rows (u, v) each; those that do not vary over the recordings are left out.
std::vector<Condition> board_conditions(const BoardsInput& input);

// Views that the user could take next with the first camera and the first board: near and far, tilted, turned in its
// plane, in the corners of the image, upside down. Their corners are those that are expected inside the image.
struct BoardProposal {
  Proposal told;
  BoardsInput::View view;
};
std::vector<BoardProposal> board_proposals(const BoardsInput& input);

// d(u, v) for one millimetre along an axis of the board, at its stated pose, the lens left out.
Vec2 by_millimetre(const BoardsInput& input, const BoardsInput::View& view, const BoardsInput::Corner& corner,
                   Vec3 axis);

// Where a board's columns or rows stand beside where they should, by as much in all views: words, or nothing.
std::string uneven_print(const BoardsInput& input, const Explanation& explanation);

// The shapes of boards that board.shape is named on, in millimetres: words, or nothing.
std::string shapes_in_words(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                            const Explanation& explanation);

// How far the corners of boards stand beside their printed places where board.print is named: words, or nothing.
std::string prints_in_words(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                            const Explanation& explanation);

// Do the poses predict the motions that a rolling shutter has been given?
std::optional<Testimony> motion_objection(const Problem& problem, const BoardsInput& input,
                                          const std::vector<BoardRole>& roles, const Explanation& explanation,
                                          std::size_t candidate);

// How far off the base model puts the board, and rivals that could stand in the place of what is named, with their
// numbers, where that is 2 % or more of its distance; words, or nothing.
std::string rivals_cost(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                        const Explanation& explanation);

void upgrade_boards(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                    const Explanation& explanation, manifest::Document& document);
Illustration illustrate_boards(const BoardsInput& input, const Observations& observations,
                               const Explanation& explanation);

}  // namespace gonio::explain
