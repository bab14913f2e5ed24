//! Short drives through one junction, each as a picture: where everybody is from second to second, and what the ego decides.
//!
//! `cargo run -p cede-controller --example replays -- docs/replays`

mod picture;
mod scene;

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os()
        .nth(1)
        .ok_or("give the folder to write to")?;
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    for scene in scene::ALL {
        let replay = scene.play()?;
        let file = folder.join(format!("{}.svg", scene.name));
        std::fs::write(&file, picture::of(scene, &replay)?)?;
        println!("{}: {}", file.display(), replay.turning_point);
    }
    Ok(())
}
