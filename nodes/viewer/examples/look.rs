use grainlab_viewer::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let loaded = grainlab_recordings::import::load(a[1].as_ref(), &Default::default()).unwrap();
    let views: Vec<View> = loaded.packings.iter().map(|p| View::new(&p.packing, p.source.clone())).collect();
    let t = std::time::Instant::now();
    let all: Vec<&View> = views.iter().collect();
    std::fs::write(&a[2], page("A packing", "about", "packing", &all).unwrap()).unwrap();
    println!("page {:?}", t.elapsed());
    for q in Quantity::ALL {
        let t = std::time::Instant::now();
        let png = Picture::with_legend(all.last().unwrap(), q, "1200x900".parse().unwrap()).png().unwrap();
        println!("png {:?}", t.elapsed());
        std::fs::write(format!("{}.{}.png", a[2], q.name()), png).unwrap();
    }
}
