// The lists of names that were replaced by the field's standard words, and what stands in their place.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace surefoot::house {

struct Banned {
    std::string_view name, instead;
};

inline const std::vector<Banned>& banned_names() {
    static const std::vector<Banned> names = {
        {"absorbed", "combined"},
        {"ask", "evaluate or schedule"},
        {"ask_axes", "evaluate_axes"},
        {"ask_hat", "evaluate_hat"},
        {"ask_ns", "answer_limit_ns"},
        {"ask_relative", "evaluate_relative"},
        {"Asked", "DeviceOutput or Requested"},
        {"asked", "output or requested"},
        {"asks", "requests_motion"},
        {"attend", "dispatch or poll_live or supervise"},
        {"Attendant", "DeviceRouter"},
        {"attendant", "router"},
        {"Attended", "Attached"},
        {"attended", "attached"},
        {"Bakery", "BakeContext"},
        {"bakery", "context"},
        {"bent", "custom_normal"},
        {"bent_", "custom_normal_"},
        {"Beside", "ThreadedDiscoverer"},
        {"black_box", "incident_recorder"},
        {"black_box_", "incident_recorder_"},
        {"BlackBox", "IncidentRecorder"},
        {"BlackBoxOptions", "IncidentRecorderOptions"},
        {"Cover", "CutBuilder or TriangleCoverage"},
        {"develop", "render_snapshot"},
        {"discover_beside", "threaded_discoverer"},
        {"discover_here", "inline_discoverer"},
        {"do_button", "evaluate_button"},
        {"flight_recorder", "incident_recorder"},
        {"FlightRecorder", "IncidentRecorder"},
        {"Foresight", "PredictedRegion"},
        {"foresight", "predicted"},
        {"foretold", "expected"},
        {"ForetoldEvents", "ExpectedEvents"},
        {"gather_up", "propagate_up"},
        {"Habit", "ReportCadence"},
        {"habit", "cadence"},
        {"hold_down", "enforce_monotone_benefit"},
        {"input_told", "reported_input"},
        {"Look", "CutFixture or TerminalStyle"},
        {"look_at_children", "visit_children"},
        {"lost_notes", "lost_messages"},
        {"make_ready", "make_attachment"},
        {"make_shot_store", "make_snapshot_store"},
        {"mend", "repair"},
        {"mend_checksums", "repair_checksums"},
        {"mend_corners", "repair_corners"},
        {"mend_uvs", "repair_uvs"},
        {"Mended", "Repairs"},
        {"mended", "corrected or repaired or resealed"},
        {"MetDevice", "KnownDevice"},
        {"narrow", "cull_planes"},
        {"News", "ReportActivity"},
        {"news", "activity"},
        {"next_note", "next_message"},
        {"note_loss", "record_loss"},
        {"note_told", "mark_reported"},
        {"noted", "format_message"},
        {"NoteLine", "MessageLine"},
        {"OpensBeside", "ThreadedLineOpener"},
        {"OpensHere", "InlineLineOpener"},
        {"Places", "CoincidentVertices"},
        {"put_off_", "deferred_"},
        {"put_off_count_", "deferred_count_"},
        {"Readied", "DeviceAttachment"},
        {"readied", "attachment"},
        {"readier", "attachment_factory"},
        {"ReadyDevice", "SteeringAttachment"},
        {"ReportShot", "ReportSnapshot"},
        {"ring_bell", "signal_event"},
        {"said", "messages or reported or sent"},
        {"Say", "MessageSink"},
        {"say", "emit or log or notify or print or write"},
        {"says", "expects"},
        {"settle", "robust_frame_times"},
        {"settle_at_most_ns", "max_rest_wait_ns"},
        {"settle_ns", "debounce_ns"},
        {"settle_s", "debounce_s"},
        {"settle_ties", "apply_depth_bias"},
        {"Settled", "FrameTimes"},
        {"settled", "frame_times"},
        {"Shot", "FrameSnapshot"},
        {"shot", "snapshot"},
        {"shot_card", "snapshot_card"},
        {"shot_cards", "snapshot_cards"},
        {"shot_memory_bytes", "snapshot_memory_bytes"},
        {"shot_of", "snapshot_of"},
        {"shots", "snapshots"},
        {"shots_", "snapshots_"},
        {"shots_s", "snapshots_s"},
        {"shots_that_fit", "snapshots_that_fit"},
        {"ShotStore", "SnapshotStore"},
        {"silent", "timed_out"},
        {"Standing", "ServiceState"},
        {"standing", "state"},
        {"standing_", "state_"},
        {"Surfaces", "PixelEstimator"},
        {"tell", "emit or notify"},
        {"TellingStages", "SignallingStages"},
        {"tells", "reports"},
        {"terminal_look", "terminal_style"},
        {"thrift", "cost_penalty"},
        {"tie_ranks", "depth_bias_ranks"},
        {"TieRanks", "DepthBiasRanks"},
        {"ties", "depth_bias"},
        {"times_said", "count_messages"},
        {"tired", "must_release"},
        {"told", "notified or reported"},
        {"UdevTold", "UdevEventTime"},
        {"unforetold", "unexpected"},
        {"upper_factor", "headroom"},
        {"upper_factor_of", "headroom_of"},
        {"Visit", "NodeVisit or StackEntry or TourController or Visitor"},
        {"waiting_said_", "unused_reported_"},
        {"WalkWatch", "WalkObserver"},
        {"was_told", "was_reported"},
        {"watch_with", "attach_monitor"},
        {"Wish", "MotionRequest or StopRequest"},
        {"wish", "request"},
        {"wishes", "requests"},
        {"wrongness", "unusable_penalty"},
    };
    return names;
}

/// Identifiers that begin so.
inline const std::vector<Banned>& banned_prefixes() {
    static const std::vector<Banned> prefixes = {
        {"most_", "max_"},      {"least_", "min_"},     {"say_", "log_ or warn_ or print_"}, {"tell_", "notify_"},
        {"told_", "reported_"}, {"said_", "reported_"}, {"note_", "message_ or record_"},
    };
    return prefixes;
}

/// Names of the product and of scripts alone: tests may call a smallest value the least.
inline const std::vector<Banned>& banned_in_product() {
    static const std::vector<Banned> names = {{"most", "max_..."}, {"least", "min_..."}, {"notes_", "messages_"}};
    return names;
}

/// Names with a prefix that stay, for they are keys of a contract.
inline constexpr std::array<std::string_view, 1> contracts = {"note_count"};

/// Words in a row that stand nowhere in an identifier, however it is written: put_off is found in take_put_off and TakePutOff.
inline const std::vector<Banned>& banned_words() {
    static const std::vector<Banned> words = {
        {"attendant", "router"},
        {"bakery", "context"},
        {"beside_workers", "at_worker_priority"},
        {"black_box", "incident_recorder"},
        {"foresight", "predicted"},
        {"foretold", "expected"},
        {"place_buffer", "JumpBuffer"},
        {"put_off", "deferred"},
        {"readied", "attachment"},
        {"shot", "snapshot"},
        {"shots", "snapshots"},
        {"thrift", "cost_penalty"},
        {"tie_ranks", "depth_bias_ranks"},
        {"visit_test", "TourControllerTest"},
        {"wrongness", "unusable_penalty"},
    };
    return words;
}

/// Those of them that a comment may not use either: the others are plain English too.
inline bool banned_in_comments(std::string_view words) { return words != "put_off"; }

/// Sources by path without ending. No file of another folder may have the name either.
inline const std::vector<Banned>& banned_files() {
    static const std::vector<Banned> files = {
        {"input/devices/attendant", "device_router"},
        {"input/devices/discover_beside", "threaded_discoverer"},
        {"input/devices/discover_here", "inline_discoverer"},
        {"input/notes", "messages"},
        {"input/safety/habit", "report_cadence"},
        {"tests/input/attendant_test", "device_router_test"},
        {"tests/input/foretold_events", "expected_events"},
        {"tools/walk/visit", "tour_controller"},
        {"tests/walk/visit_test", "tour_controller_test"},
        {"systemd/daemon/standing", "service_state"},
        {"tools/walk/shots", "snapshots"},
        {"rt/monitor/black_box", "incident_recorder"},
        {"tests/rt/black_box_test", "incident_recorder_test"},
        {"render/model/surfaces", "pixel_estimator"},
        {"tests/model/surfaces_test", "pixel_estimator_test"},
        {"render/draw/ties", "coincidence"},
        {"render/prepare/passes", "tree_passes"},
        {"render/select/queue", "bucket_queue"},
        {"render/select/fixed", "flat_distance"},
        {"render/select/search", "depth_first"},
        {"render/select/cover", "cut_builder"},
        {"render/measure/cover", "triangle_coverage"},
        {"render/import/mend", "repair"},
        {"tools/soak/judge", "soak_verdict"},
        {"tests/soak/judge_test", "soak_verdict_test"},
        {"tools/selftest/judge", "scene_check"},
        {"tools/selftest/look", "cut_fixture"},
        {"tools/monitor/watch", "attach_monitor"},
    };
    return files;
}

}  // namespace surefoot::house
