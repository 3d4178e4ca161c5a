#include "byre/place/vocabulary.h"

#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/io/image/image_names.h"

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct TrainOptions {
  std::vector<fs::path> images;
  fs::path output;
  VocabularyOptions tree;
  int features = 5000;  // largest number per image
  bool quiet = false;
};

struct ImportOptions {
  fs::path input;
  fs::path output;
};

constexpr const char* kTrainFooter = R"(Examples:
  byre vocabulary train photos -o my.vocabulary
  byre vocabulary train barn/*.png office/*.png -o my.vocabulary --branching 16 --depth 4 --seed 7

The same images, options and seed give the same file. BYRE_VOCABULARY=my.vocabulary makes byre use this file.)";

std::vector<std::vector<Descriptor>> describe_images(const TrainOptions& options) {
  const std::vector<fs::path> files = find_images(options.images);
  Progress progress(std::cerr, progress_style(options.quiet), static_cast<int>(files.size()), "images");
  const Stopwatch watch;
  ImageDescriber describer(options.features);
  std::vector<std::vector<Descriptor>> descriptors_of_images;
  std::vector<std::string> warnings;
  for (int i = 0; i < static_cast<int>(files.size()); ++i) {
    const fs::path& file = files[static_cast<std::size_t>(i)];
    std::optional<std::vector<Descriptor>> descriptors = describer.descriptors_of(file);
    if (descriptors) {
      descriptors_of_images.push_back(std::move(*descriptors));
    } else {
      warnings.push_back(file.string() + ": cannot be read as an image, skipped");
    }
    progress.update(i + 1, watch.seconds(), "describing");
  }
  progress.close();
  if (!options.quiet) show_warnings(std::cerr, warnings);
  return descriptors_of_images;
}

Vocabulary train_with_progress(const TrainOptions& options, const std::vector<std::vector<Descriptor>>& descriptors) {
  constexpr int kPercent = 100;
  Progress progress(std::cerr, progress_style(options.quiet), kPercent, "%");
  const Stopwatch watch;
  const auto show = [&](double share) {
    progress.update(static_cast<int>(kPercent * share), watch.seconds(), "clustering");
  };
  Vocabulary vocabulary = Vocabulary::train(descriptors, options.tree, show);
  progress.close();
  return vocabulary;
}

std::string to_text(const Vocabulary& vocabulary, const fs::path& path) {
  return row("vocabulary", path.string()) +
         fmt::format("words        {}\nbranching    {}\ndepth        {}\nchecksum     {:016x}\n",
                     vocabulary.word_count(), vocabulary.branching(), vocabulary.depth(),
                     static_cast<unsigned long long>(vocabulary.checksum()));
}

ExitCode run_train(const TrainOptions& options, std::ostream& result) {
  require_writable(options.output);
  limit_image_threads(1);
  const std::vector<std::vector<Descriptor>> descriptors = describe_images(options);
  const Vocabulary vocabulary = train_with_progress(options, descriptors);
  vocabulary.save(options.output);
  std::size_t descriptor_count = 0;
  for (const auto& image : descriptors) descriptor_count += image.size();
  result << to_text(vocabulary, options.output)
         << fmt::format("trained on   {} descriptors of {} images\n", descriptor_count, descriptors.size());
  return ExitCode::done;
}

ExitCode run_import(const ImportOptions& options, std::ostream& result) {
  require_writable(options.output);
  const Vocabulary vocabulary = Vocabulary::import_dbow2(options.input);
  vocabulary.save(options.output);
  result << to_text(vocabulary, options.output);
  return ExitCode::done;
}

ExitCode run_show(const std::optional<fs::path>& file, std::ostream& result) {
  const fs::path path = file ? *file : default_vocabulary_path();
  result << to_text(Vocabulary::load(path), path);
  return ExitCode::done;
}

void declare_output(CLI::App& command, fs::path& output) {
  add_output(command, Output::vocabulary, "-o,--output", output, "Vocabulary file to write")->required();
}

Action declare_train(CLI::App& command) {
  const auto options = std::make_shared<TrainOptions>();
  add_input(command, Input::images, "IMAGES", options->images, "Image files, and folders of image files")
      ->type_name("FILE|FOLDER")
      ->required();
  declare_output(command, options->output);
  const auto add_number = [&command](const char* name, int& value, int min, int max, const char* meaning) {
    command.add_option(name, value, meaning)->type_name("N")->check(between(min, max))->capture_default_str();
  };
  add_number("--branching", options->tree.branching, 2, 255, "Children of a node of the tree");
  add_number("--depth", options->tree.depth, 1, 16, "Levels of the tree, with at most branching^depth words");
  add_number("--features", options->features, 1, 1'000'000, "Maximum number of features per image");
  command.add_option("--seed", options->tree.seed, "Random seed of the clustering")
      ->type_name("N")
      ->check(from(0.0))
      ->capture_default_str();
  command.add_flag("--quiet", options->quiet, "Show no progress and no warnings");
  command.footer(kTrainFooter);
  return [options](std::ostream& result) { return run_train(*options, result); };
}

Action declare_import(CLI::App& command) {
  const auto options = std::make_shared<ImportOptions>();
  add_input(command, Input::file, "INPUT", options->input, "DBoW2 text file of 256-bit descriptors")
      ->type_name("FILE")
      ->required();
  declare_output(command, options->output);
  return [options](std::ostream& result) { return run_import(*options, result); };
}

Action declare_show(CLI::App& command) {
  const auto file = std::make_shared<std::optional<fs::path>>();
  add_input(command, Input::file, "VOCABULARY", *file, "Vocabulary file (the one that byre uses)")->type_name("FILE");
  return [file](std::ostream& result) { return run_show(*file, result); };
}

}  // namespace

Action declare_vocabulary(CLI::App& command) {
  return declare_subcommands(command, {{"train", "Train a vocabulary on images", declare_train},
                                       {"import", "Import a DBoW2 vocabulary", declare_import},
                                       {"show", "Print size and checksum of a vocabulary", declare_show}});
}

}  // namespace byre::cli
