use cede_verify::network::*;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
}
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let filter = std::env::args().nth(2).unwrap_or_default();
    let timeout: u64 = std::env::args().nth(3).map_or(60, |s| s.parse().unwrap());
    let list = std::fs::read_to_string(format!("{dir}/instances.csv")).unwrap();
    let (mut total, mut boxes, mut wrong) = (0.0, 0, 0);
    for line in list.lines().skip(1) {
        if !filter.split('+').all(|f| line.contains(f)) { continue; }
        let f: Vec<&str> = line.split(',').collect();
        let n = onnx::read(&std::fs::read(format!("{dir}/{}", f[0])).unwrap()).unwrap();
        let p = vnnlib::read(&std::fs::read_to_string(format!("{dir}/{}", f[1])).unwrap()).unwrap();
        let t = cpu(); let w = std::time::Instant::now();
        let r = verify(&n, &p, Settings { timeout: std::time::Duration::from_secs(timeout), seed: 0, record: std::env::var("CHECK").is_ok(), branching: if std::env::var("PHASES").is_ok() {Branching::Phases} else {Branching::Auto} }).unwrap();
        let used = cpu() - t;
        let t = cpu();
        for (q, proof) in p.queries.iter().zip(&r.proofs) {
            let text = proof.to_text();
            let proof = proof::Proof::from_lines(&mut text.lines().enumerate()).unwrap();
            println!("   check {:?} {} bytes", check::check(&n, q, &proof), text.len());
        }
        if !r.proofs.is_empty() { println!("   check cpu {:.2}", cpu() - t); }
        let name = match r.answer { Answer::Unsat => "unsat", Answer::Sat(_) => "sat", Answer::Timeout => "timeout", Answer::Unknown => "unknown" };
        total += used; boxes += r.regions; if name != f[2] { wrong += 1; }
        println!("{} {} {} {} cpu {used:.2} wall {:.2} boxes {} us/box {:.1} {}", f[0], f[1], name, f[2], w.elapsed().as_secs_f64(), r.regions, used*1e6/r.regions.max(1) as f64, if name != f[2] {"<<<<"} else {""});
    }
    println!("total cpu {total:.2} boxes {boxes} disagree {wrong}");
}
