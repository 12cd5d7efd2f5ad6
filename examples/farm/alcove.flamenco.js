// A job type of Flamenco 3: put this file into the folder scripts beside flamenco-manager.
// SPDX-License-Identifier: BSD-3-Clause
const JOB_TYPE = {
    label: "Alcove ambient occlusion",
    settings: [
        { key: "frames", type: "string", required: true, eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          evalInfo: { showLinkButton: true, description: "Frames of the scene" },
          description: "Such as 1001-1100, 1200" },
        { key: "chunk_size", type: "int32", default: 20, visible: "submission", description: "Frames of a task" },
        { key: "input", type: "string", subtype: "file_path", required: true,
          description: "The frames, such as /shots/shot.%04d.exr" },
        { key: "output", type: "string", subtype: "file_path", required: true,
          description: "Where the AO goes, such as /shots/ao/shot.%04d.exr" },
        { key: "camera", type: "string", subtype: "file_path", default: "",
          description: "A camera file; empty: the frames tell their camera, as those with a Position pass do" },
        { key: "radius", type: "string", default: "0.5", description: "How far occluders reach, scene units" },
        { key: "preset", type: "string", default: "standard" },
        { key: "alcove", type: "string", default: "alcove", visible: "submission",
          description: "The program, on each worker's path, or a variable of the manager such as {alcove}" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    const camera = settings.camera ? ["--camera", settings.camera] : [];
    for (let frames of frameChunker(settings.frames, settings.chunk_size)) {
        const task = author.Task(`alcove-${frames}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: settings.alcove,
            args: ["run", settings.input, "-o", settings.output, "--frames", frames, "--radius", settings.radius,
                   "--preset", settings.preset, "--resume"].concat(camera),
        }));
        job.addTask(task);
    }
}
