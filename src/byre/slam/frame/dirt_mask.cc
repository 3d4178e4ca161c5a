#include "byre/slam/frame/dirt_mask.h"

#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr int kMinTrials = 30;        // trials in the rest of the image
constexpr double kCleanShare = 0.6;   // minimum share of found points in a clean cell, relative to the rest
constexpr double kDirtyShare = 0.1;   // share of points found behind dirt, mostly by chance
const double kProof = std::log(1e6);  // log-likelihood ratio of a dirty cell
// Dirt is larger than a cell, so less evidence is needed next to a dirty cell.
const double kProofBesideDirt = std::log(1e2);
const double kSuspicious = std::log(10.0);  // cells that do not count as the rest of the image

// Evidence of simultaneous trials in a cell; found: share of points found. Such trials often show one object, so their
// weight is the square root of their number.
double evidence_of(double found, int trials, double rest) {
  const double clean = kCleanShare * rest;
  const double dirty = kDirtyShare * rest;
  return std::sqrt(trials) *
         (found * std::log(dirty / clean) + (1.0 - found) * std::log((1.0 - dirty) / (1.0 - clean)));
}

}  // namespace

bool DirtMask::is_next_to_dirt(std::size_t cell) const {
  constexpr auto kColumns = static_cast<std::size_t>(ImageMask::kColumns);
  const std::size_t column = cell % kColumns;
  return (column > 0 && hidden_.is_hidden(cell - 1)) || (column + 1 < kColumns && hidden_.is_hidden(cell + 1)) ||
         (cell >= kColumns && hidden_.is_hidden(cell - kColumns)) ||
         (cell + kColumns < ImageMask::kCells && hidden_.is_hidden(cell + kColumns));
}

void DirtMask::note(std::span<const DirtTrial> trials, const Rig& rig) {
  for (const DirtTrial& trial : trials) {
    Count& count = counts_[ImageMask::cell_of(trial.pixel, rig)];
    ++count.all;
    count.found += trial.is_found ? 1 : 0;
  }
  std::array<bool, ImageMask::kCells> of_rest{};
  Count rest;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    of_rest[cell] = !hidden_.is_hidden(cell) && evidence_[cell] < kSuspicious;
    if (of_rest[cell]) rest = {rest.found + counts_[cell].found, rest.all + counts_[cell].all};
  }
  if (rest.all < kMinTrials) return;
  ImageMask after = hidden_;
  for (std::size_t cell = 0; cell < counts_.size(); ++cell) {
    const Count here = std::exchange(counts_[cell], {});
    const Count others = of_rest[cell] ? Count{rest.found - here.found, rest.all - here.all} : rest;
    if (here.all == 0 || others.found == 0) continue;
    const double found = static_cast<double>(here.found) / here.all;
    const double found_elsewhere = static_cast<double>(others.found) / others.all;
    double& evidence = evidence_[cell];
    evidence = std::clamp(evidence + evidence_of(found, here.all, found_elsewhere), 0.0, kProof);
    if (evidence >= (is_next_to_dirt(cell) ? kProofBesideDirt : kProof)) after.set(cell, true);
    if (evidence == 0.0) after.set(cell, false);
  }
  hidden_ = after;
}

}  // namespace byre
