#include "sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "fringe/error.hpp"
#include "fringe/live_scene.hpp"
#include "fringe/motion.hpp"
#include "fringe/progress.hpp"
#include "fringe/reading.hpp"
#include "fringe/remarks.hpp"
#include "fringe/scene_reader.hpp"
#include "fringe/version.hpp"
#include "interruption.hpp"
#include "measured.hpp"
#include "numeric/infinity.hpp"
#include "program.hpp"
#include "sweep_table.hpp"
#include "whole_files.hpp"

namespace fringe::cli {
namespace {

namespace fs = std::filesystem;

/// A method of the sweep and what it says, frame by frame.
struct Sweeper {
  MethodRequest request;
  EvaluationOptions options;
  std::vector<std::vector<Noticed>> noticed = {};  ///< for every frame and reading
  bool reached = true;
  std::vector<std::size_t> refused = {};  ///< numbers of the frames without an answer
  std::string reason = {};                ///< why the first of these has none
};

/// Returns a line for every reading with a threshold: in which frames it is noticed.
std::string summary(const Scene& scene, const std::vector<Frame>& motion, const Sweeper& sweeper,
                    bool names_method) {
  std::string text;
  const std::vector<Reading> described = readings(scene);
  for (std::size_t k = 0; k < described.size(); ++k) {
    if (!described[k].threshold)
      continue;
    text += fmt::format("{}, threshold {:.6g} fF{}:", described[k].name,
                        *described[k].threshold * femtofarads_per_farad,
                        names_method ? ", by " + *sweeper.request.method : "");
    std::string before;
    for (std::size_t frame = 0; frame < sweeper.noticed.size(); ++frame) {
      const Noticed now = sweeper.noticed[frame][k];
      const std::string words = now == Noticed::yes      ? "noticed"
                                : now == Noticed::no     ? "not noticed"
                                : now == Noticed::unsure ? "not sure"
                                                         : "not known";
      if (words != before)
        text += fmt::format("{} {} from frame {} ({})", before.empty() ? "" : ",", words, frame + 1,
                            motion[frame].name);
      before = words;
    }
    text += "\n";
  }
  return text;
}

/// Shows on a terminal what is being computed.
void show_progress(std::size_t frame, std::size_t frames, const std::string& method) {
  // Blanks cover what the longest text has left behind.
  if (isatty(STDERR_FILENO) != 0)
    fmt::print(stderr, "\rfringe: frame {} of {}, {:<64}", frame, frames, method);
}

/// Seconds that an answer gets at least: a limit must be positive.
constexpr double least_seconds = 1e-3;

/// The end of a sweep before that of its motion, by Ctrl-C or a limit of time.
class End {
 public:
  explicit End(std::optional<double> most_seconds) : most_seconds_(most_seconds) {}

  double seconds_left() const {
    using Clock = std::chrono::steady_clock;
    return most_seconds_.value_or(detail::infinity) -
           std::chrono::duration<double>(Clock::now() - start_).count();
  }
  bool is_near() const { return interruption_.is_asked_for() || seconds_left() <= 0; }
  int status() const { return interruption_.is_asked_for() ? interrupted : not_reached; }
  std::string reason() const {
    return interruption_.is_asked_for() ? "interrupted" : fmt::format("stopped after {:g} s", *most_seconds_);
  }

 private:
  std::optional<double> most_seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  CommandInterruption interruption_;
};

/// The answers of all methods for one frame, and how many of them were kept from earlier or refused.
struct FrameAnswers {
  std::vector<FrameRows> rows;
  std::size_t found = 0;
  std::size_t refused = 0;
  std::set<std::string> remarks = {};  ///< on the first frame
};

/// Answers one frame by every method, or takes what earlier rows hold; nothing if it was interrupted.
std::optional<FrameAnswers> answer_frame(LiveScene& live, const std::vector<Sweeper>& sweepers,
                                         const EarlierRows& earlier, const SweepKey& key,
                                         const std::vector<Frame>& motion, std::size_t frame,
                                         const End& end) {
  const std::string& name = motion[frame].name;
  live.set_poses(motion[frame].poses);
  FrameAnswers answers;
  for (const Sweeper& sweeper : sweepers) {
    const std::string& method = *sweeper.request.method;
    const std::string own = key.of(motion[frame], sweeper.request);
    std::optional<FrameRows> rows = earlier.find(live.scene(), frame + 1, name, method, own);
    answers.found += rows.has_value() ? 1 : 0;
    show_progress(frame + 1, motion.size(), method);
    const ProgressScope progress([&](const std::string& text) {
      show_progress(frame + 1, motion.size(), fmt::format("{}: {}", method, text));
    });
    try {
      if (!rows) {
        EvaluationOptions options = sweeper.options;
        if (options.max_seconds)
          options.max_seconds = std::max(end.seconds_left(), least_seconds);
        const Evaluation& answer = live.evaluate(options);
        // An answer that was cut short is none of the sweep's.
        if (end.is_near() && !answer.reached)
          return std::nullopt;
        rows = answered_rows(live.scene(), frame + 1, name, method, answer, own);
        // Not on every frame: that may take longer than its answer.
        if (frame == 0)
          for (std::string& remark : remarks(live.scene(), sweeper.options, answer))
            answers.remarks.insert(std::move(remark));
      }
    } catch (const Interrupted&) {
      return std::nullopt;
    } catch (const InputError& error) {
      // The other methods may still answer.
      ++answers.refused;
      rows = refused_rows(live.scene(), frame + 1, name, method);
      rows->refused = error.what();
    }
    answers.rows.push_back(*std::move(rows));
  }
  return answers;
}

/// Returns the methods of a sweep with their options.
std::vector<Sweeper> sweepers_of(const SweepRequest& request) {
  std::vector<Sweeper> sweepers;
  const std::vector<std::string> usual{request.options.rtol ? "auto" : "exact"};
  for (MethodRequest& method :
       requests_of(request.methods.empty() ? usual : request.methods, request.options))
    sweepers.push_back({.request = method, .options = options_of(method)});
  return sweepers;
}

/// Says on standard error what was refused, and which errors were not reached.
void tell(const std::string& scene, const std::vector<Sweeper>& sweepers) {
  for (const Sweeper& sweeper : sweepers) {
    const std::string by = sweepers.size() > 1 ? fmt::format("{}: ", *sweeper.request.method) : "";
    if (!sweeper.refused.empty())
      fmt::print(stderr, "fringe: {}: {}no answer in frames {}: {}\n", scene, by,
                 fmt::join(sweeper.refused, ", "), sweeper.reason);
    if (!sweeper.reached)
      fmt::print(stderr, "fringe: {}: {}an error of {} was not reached in every frame\n", scene, by,
                 rtol_of(sweeper.options));
  }
}

}  // namespace

fs::path motion_file(const fs::path& scene, const std::optional<std::string>& named) {
  return named ? fs::path(*named) : fs::path(scene).replace_extension(".motion.toml");
}

CLI::App* add_sweep_command(CLI::App& program, SweepRequest& request) {
  CLI::App* command = program.add_subcommand(
      "sweep", "The readings of a scene in every frame of a motion, as CSV, and where they are noticed");
  command->set_version_flag("--version", version());
  command->add_option("SCENE", request.scene, "The scene file (TOML)")->required();
  command->add_option("--motion", request.motion, "The motion file (if not given, SCENE.motion.toml)")
      ->type_name("FILE");
  command
      ->add_option("--method", request.methods,
                   "One or more methods of fringe capacitance, separated by commas or each with a --method "
                   "of its own; the other options go to those methods that have them")
      ->delimiter(',')
      ->default_str("auto with --rtol, else exact");
  add_accuracy_options(*command, request.options);
  command
      ->add_option("--output", request.output,
                   "Write the CSV to this file, after every frame, and print a summary. Frames that it "
                   "holds already, of the same scene, poses and options, are not computed again. Missing "
                   "folders are made")
      ->type_name("FILE.csv");
  return command;
}

int run_sweep(const SweepRequest& request) {
  // Wrong options are told before the scene is read, which may take long.
  std::vector<Sweeper> sweepers = sweepers_of(request);
  LiveScene live(load_scene(request.scene));
  const std::vector<Frame> motion = load_motion(motion_file(request.scene, request.motion), live.scene());
  const SweepKey key(request.scene, live.scene());
  EarlierRows earlier;
  std::optional<MissingFolders> folders;
  if (request.output) {
    earlier = EarlierRows(*request.output);
    folders.emplace(fs::absolute(*request.output).parent_path());
    expect_writable(*request.output);
  }
  std::string table = sweep_header;
  std::size_t kept = 0, finished = 0, unanswered = 0;
  const End end(request.options.max_seconds);
  for (std::size_t frame = 0; frame < motion.size() && !end.is_near(); ++frame) {
    try {
      const std::optional<FrameAnswers> answers =
          answer_frame(live, sweepers, earlier, key, motion, frame, end);
      if (!answers)
        break;
      unanswered += answers->refused == sweepers.size() ? 1 : 0;
      for (std::size_t k = 0; k < sweepers.size(); ++k) {
        const FrameRows& rows = answers->rows[k];
        table += rows.text;
        sweepers[k].noticed.push_back(rows.noticed);
        sweepers[k].reached = sweepers[k].reached && rows.reached;
        if (!rows.refused.empty()) {
          if (sweepers[k].refused.empty())
            sweepers[k].reason = rows.refused;
          sweepers[k].refused.push_back(frame + 1);
        }
      }
      print_remarks({answers->remarks.begin(), answers->remarks.end()});
      kept += answers->found == sweepers.size() ? 1 : 0;
      ++finished;
    } catch (const InputError& error) {
      throw InputError(
          fmt::format("{}: frame {} ({}): {}", request.scene, frame + 1, motion[frame].name, error.what()));
    }
    if (request.output && unanswered < finished) {
      write_whole({{*request.output, table}});
      folders->keep();
    }
  }
  if (unanswered > 0 && unanswered == finished)
    throw InputError(
        fmt::format("{}: frame 1 ({}): {}", request.scene, motion.front().name, sweepers.back().reason));
  if (isatty(STDERR_FILENO) != 0)
    fmt::print(stderr, "\n");
  if (!earlier.empty() && kept == 0)
    fmt::print(stderr, "fringe: {}: its frames were of another scene, motion or options, and are replaced\n",
               request.output->string());
  const bool is_cut_short = finished < motion.size();
  if (is_cut_short)
    fmt::print(stderr, "fringe: {}: {} after {} of {} frames\n", request.scene, end.reason(), finished,
               motion.size());
  tell(request.scene, sweepers);
  std::string text = table;
  if (request.output) {
    text = fmt::format("{}: {} frames{}\n", request.output->string(), finished,
                       kept > 0 ? fmt::format(", {} of which were there", kept) : "");
    for (const Sweeper& sweeper : sweepers)
      text += summary(live.scene(), motion, sweeper, sweepers.size() > 1);
  }
  print(text);
  if (is_cut_short)
    return end.status();
  return unanswered == 0 && std::ranges::all_of(sweepers, &Sweeper::reached) ? answered : not_reached;
}

}  // namespace fringe::cli
