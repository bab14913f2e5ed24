(* Theorem 4 from what shields count: of two claims one is newer, by the grace that Theorem 3 counts. *)
Require Import Reals Lra Lia Psatz Arith.
Require Import Contract Shipped Motion Reach Statement Ego Apart Precedence Turns Yield Lanes.

Section Newer.
Variables (k : contract) (v : bool -> R -> R) (arrival : bool -> R) (from r : R).
Hypothesis ok : valid k.
Hypothesis keeps : forall x, keeps_contract k (v x) from.
(* m calls of motion end a count; T is the patience, G the grace. *)
Variables (m T G : nat).
Hypothesis en : enough k m.
Hypothesis patient : (5 <= T)%nat.
Hypothesis graceful : (m + 2 <= G)%nat.
Hypothesis jitter_small : (jitter k <= period k / 8)%R.
(* The grace is so long that who goes is seen to: `grace` in waiting.rs. *)
Hypothesis seen_to_go : (r < INR (G - m - 1) * (ego_go k * period k))%R.

(* From a call to the one at which a turn is taken: so long before, the other has no claim any more. *)
Definition d := (G + 1 - m)%nat.

Notation counts := (counts k v arrival from r m).
Notation takes_turns := (takes_turns T G).
Notation claims_by_arrival := (claims_by_arrival T).
Notation begins := (begins T).

Lemma next_one g i : on_grid k g -> (g i < g (i + 1)%nat)%R.
Proof. intros gg. pose proof (spacing k g gg i 1) as [A _]. simpl INR in A. destruct ok. lra. Qed.

Lemma three : (m = 2 \/ m = 3)%nat.
Proof. destruct en as [[-> _] | [-> _]]; auto. Qed.

(* Lemma 4: a shield's S is no more than its L. *)
Lemma own_count g sure ended S_ L i l : counts g sure ended S_ L -> L i = Some l -> (S_ i <= l)%nat.
Proof.
  intros C known. destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ C i l known) as (li & end_ & _).
  destruct (le_lt_dec (S_ i) l) as [? | more]; [assumption | exfalso].
  destruct (S_counts _ _ _ _ _ _ _ _ _ _ _ C i) as [_ stretch].
  pose proof (stretch (i - l)%nat ltac:(lia) ltac:(lia)) as s.
  destruct (ended_by _ _ _ _ _ _ _ _ _ _ _ C _ end_) as (x & why).
  destruct (sure_of _ _ _ _ _ _ _ _ _ _ _ C _ s x) as [still here].
  destruct why as [absent | [back fast]]; [lra |].
  pose proof (fast (i - l)%nat ltac:(lia)).
  assert (0 <= dip k)%R; [| lra]. unfold dip. destruct ok.
  apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; lra].
Qed.

(* What is counted at a call was counted before, up to it. *)
Definition back (S_ : nat -> nat) (last i : nat) := if Nat.leb i last then (S_ last - (last - i))%nat else O.

Lemma counts_back g sure ended S_ L last : counts g sure ended S_ L -> counts g sure ended (back S_ last) L.
Proof.
  intros C. constructor; try apply C.
  intros i. unfold back. destruct (Nat.leb i last) eqn:e; [apply Nat.leb_le in e | split; [lia |]; intros; lia].
  destruct (S_counts _ _ _ _ _ _ _ _ _ _ _ C last) as [short stretch]. split; [lia |].
  intros j h1 h2. apply stretch; lia.
Qed.

Lemma back_is S_ last i : (i <= last)%nat -> back S_ last i = (S_ last - (last - i))%nat.
Proof. intros h. unfold back. replace (Nat.leb i last) with true by (symmetry; apply Nat.leb_le; exact h). reflexivity. Qed.

(* A turn is taken. *)
Definition takes_it (S_ : nat -> nat) (L : nat -> option nat) (owns : nat -> nat -> Prop) i n :=
  S_ i = (begins n + G)%nat /\ owns i n /\ exists l, L i = Some l /\ (begins n <= l < begins (n + 1))%nat.

(* One does not take a turn, and the other soon after. *)
Lemma not_one_after_the_other p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q i0 j0 n n' :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q -> agree p q L_q owns_p owns_q ->
  takes_it S_p L_p owns_p i0 n -> takes_it S_q L_q owns_q j0 n' ->
  (p i0 <= q j0)%R -> (q (j0 - d)%nat < p (i0 + 1)%nat)%R -> False.
Proof.
  intros P Q order (sP & oP & l0 & L0 & l0a & l0b) (sQ & oQ & lQ & LQ & lQa & lQb) first near.
  pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ P) as gp. pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ Q) as gq.
  assert (p0 : (0 < period k)%R) by (destruct ok; lra).
  pose proof three as m3. unfold d in *.
  pose proof (begins_least m T G patient graceful n). pose proof (begins_least m T G patient graceful n').
  pose proof (own_count _ _ _ _ _ _ _ P L0) as cP. pose proof (own_count _ _ _ _ _ _ _ Q LQ) as cQ. rewrite sP in cP. rewrite sQ in cQ.
  destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ Q j0 lQ LQ) as (lQj & _ & countedQ).
  destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ P i0 l0 L0) as (l0i & _ & countedP).
  pose proof (counts_back q sure_q ended_q S_q L_q j0 Q) as Qb.
  assert (old : (q (j0 - lQ)%nat <= p i0)%R).
  { pose proof (spacing k q gq (j0 - lQ) (lQ - (G + 1 - m))) as [A _].
    replace (j0 - lQ + (lQ - (G + 1 - m)))%nat with (j0 - (G + 1 - m))%nat in A by lia.
    pose proof (spacing k p gp i0 1) as [_ B]. simpl INR in B.
    assert (2 <= INR (lQ - (G + 1 - m)))%R by (change 2%R with (INR 2); apply le_INR; lia).
    assert (2 * period k <= INR (lQ - (G + 1 - m)) * period k)%R by (apply Rmult_le_compat_r; lra). lra. }
  pose proof (next_one q j0 gq).
  destruct (last_call m T G patient graceful q (j0 - lQ) j0 (p i0)) as (jx & hjx & now); [lia | lra |].
  pose proof (countedQ jx ltac:(lia)) as Cx.
  pose proof (pair_surely_at_most_perhaps k v arrival from r ok keeps m T G en patient graceful jitter_small q p _ _ _ _ _ _ _ _ Q P jx i0 _ Cx now) as five.
  rewrite sP in five.
  assert (nn : (n <= n')%nat).
  { destruct (le_lt_dec n n') as [? | lt]; [assumption | exfalso]. pose proof (begins_grows m T G patient graceful (n' + 1) n ltac:(lia)). lia. }
  (* The other way round. *)
  assert (enough_ : (begins n' <= l0)%nat).
  { destruct (Rle_lt_dec (p i0) (q (j0 - (G + 1 - m))%nat)) as [later | earlier].
    - pose proof (pair_surely_at_most_perhaps k v arrival from r ok keeps m T G en patient graceful jitter_small p q _ _ _ _ _ _ _ _ P Qb i0
                    (j0 - (G + 1 - m)) l0 L0 (conj later near)) as five'.
      rewrite back_is in five' by lia. rewrite sQ in five'. lia.
    - assert (jd : (j0 - (G + 1 - m) <= jx)%nat).
      { destruct (le_lt_dec (j0 - (G + 1 - m)) jx) as [? | lt]; [assumption | exfalso].
        pose proof (calls_ordered k q ok gq (jx + 1) (j0 - (G + 1 - m)) ltac:(lia)). lra. }
      assert (near_p : (p (i0 - 3)%nat <= q jx)%R).
      { pose proof (spacing k p gp (i0 - 3) 3) as [A _]. replace (i0 - 3 + 3)%nat with i0 in A by lia.
        pose proof (spacing k q gq jx 1) as [_ B]. simpl INR in *. lra. }
      pose proof (next_one p i0 gp).
      destruct (last_call m T G patient graceful p (i0 - 3) i0 (q jx)) as (ix & hix & nowp); [lia | lra |].
      pose proof (countedP ix ltac:(lia)) as Cp.
      pose proof (pair_surely_at_most_perhaps k v arrival from r ok keeps m T G en patient graceful jitter_small p q _ _ _ _ _ _ _ _ P Qb ix jx _ Cp nowp) as five'.
      rewrite back_is in five' by lia. rewrite sQ in five'. lia. }
  assert (nn' : (n' <= n)%nat).
  { destruct (le_lt_dec n' n) as [? | lt]; [assumption | exfalso]. pose proof (begins_grows m T G patient graceful (n + 1) n' ltac:(lia)). lia. }
  assert (n' = n) as -> by lia.
  exact (order i0 j0 n lQ first LQ old oP oQ).
Qed.

(* Q does not hold a turn soon before P takes one. *)
Lemma not_held_before p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_q i0 n j n' :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q -> takes_turns S_q L_q owns_q turn_q ->
  agree q p L_p owns_q owns_p ->
  takes_it S_p L_p owns_p i0 n -> turn_q j = Some n' -> (q j <= p i0)%R -> (p (i0 - d)%nat < q (j + 1)%nat)%R -> False.
Proof.
  intros P Q rules order takes_p held_now late early.
  pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ P) as gp. pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ Q) as gq.
  pose proof three as m3.
  destruct (taken m T G patient graceful S_q L_q owns_q turn_q j n' rules held_now) as (j0 & lej & held & sq & oq & lq).
  pose proof (calls_ordered k q ok gq j0 j lej).
  destruct (Rle_lt_dec (q j0) (p (i0 - d)%nat)) as [before | after_].
  - destruct takes_p as (sP & oP & l0 & L0 & l0a & l0b).
    pose proof (own_count _ _ _ _ _ _ _ P L0) as cP. rewrite sP in cP.
    destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ P i0 l0 L0) as (l0i & _ & counted).
    unfold d in *. pose proof (counted (i0 - (G + 1 - m))%nat ltac:(lia)) as Lx.
    pose proof (counts_back p sure_p ended_p S_p L_p i0 P) as Pb.
    destruct (last_call m T G patient graceful q j0 j (p (i0 - (G + 1 - m))%nat)) as (i1 & hi1 & now1); [lia | lra |].
    apply (no_turn_before k v arrival from r ok keeps m T G en patient graceful jitter_small q p sure_q ended_q sure_p ended_p
             S_q (back S_p i0) L_q L_p owns_q turn_q j0 i1 (i0 - (G + 1 - m)) n' n (i0 - (G + 1 - m) - (i0 - l0)) (m - 1)); auto; try lia.
    + intros i hi. apply held. lia.
    + rewrite back_is by lia. rewrite sP. lia.
    + intros near own. replace (i0 - (G + 1 - m) - (i0 - (G + 1 - m) - (i0 - l0)))%nat with (i0 - l0)%nat in near by lia.
      refine (order j0 i0 n l0 _ L0 near own oP). lra.
  - apply (not_one_after_the_other q p sure_q ended_q sure_p ended_p S_q S_p L_q L_p owns_q owns_p j0 i0 n' n); auto.
    + split; [exact sq |]. auto.
    + lra.
    + pose proof (next_one q j0 gq). lra.
Qed.

(* Nor does Q claim by arrival, soon before or at any time later. *)
Lemma no_arrival_since p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p claim i0 n j :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q -> claims_by_arrival L_q claim ->
  takes_it S_p L_p owns_p i0 n -> (p (i0 - d)%nat < q (j + 1)%nat)%R -> ~ claim j.
Proof.
  intros P Q rules (sP & _ & l0 & L0 & l0a & l0b) early cl.
  pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ P) as gp. pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ Q) as gq.
  pose proof (begins_least m T G patient graceful n) as least_. pose proof three as m3. unfold d in *.
  destruct (S_counts _ _ _ _ _ _ _ _ _ _ _ P i0) as [short stretch].
  set (x := (i0 - (G + 1 - m))%nat) in *.
  destruct (Rlt_le_dec (p x) (q 0%nat)) as [late | watched].
  - pose proof (claimed_before T L_q claim 0 j rules ltac:(lia) cl) as c0.
    destruct (L_q 0%nat) as [l |] eqn:Lq0; [| exact (not_unknown _ _ _ rules 0%nat Lq0 c0)].
    destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ Q 0%nat l Lq0) as (l0' & end_ & _).
    destruct (ended_by _ _ _ _ _ _ _ _ _ _ _ Q _ end_) as (y & [absent | [back_ _]]); [| lia].
    pose proof (stretch x ltac:(lia) ltac:(lia)) as sx. destruct (sure_of _ _ _ _ _ _ _ _ _ _ _ P x sx y) as [_ arrived].
    replace (0 - l)%nat with 0%nat in absent by lia. lra.
  - destruct (last_call m T G patient graceful q 0 j (p x)) as (i1 & h1 & now); [lia | lra |].
    pose proof (claimed_before T L_q claim i1 j rules ltac:(lia) cl) as c1.
    destruct (L_q i1) as [l1 |] eqn:L1; [| exact (not_unknown _ _ _ rules i1 L1 c1)].
    pose proof (counts_back p sure_p ended_p S_p L_p i0 P) as Pb.
    pose proof (pair_surely_at_most_perhaps k v arrival from r ok keeps m T G en patient graceful jitter_small q p _ _ _ _ _ _ _ _ Q Pb i1 x l1 L1 now) as five.
    rewrite back_is in five by lia. rewrite sP in five.
    destruct (L_counts _ _ _ _ _ _ _ _ _ _ _ Q i1 l1 L1) as (l1i & _ & counted).
    pose proof (counted (i1 - l1 + T)%nat ltac:(lia)) as C.
    replace (i1 - l1 + T - (i1 - l1))%nat with (begins 0) in C by (unfold Turns.begins; simpl; lia).
    apply (not_in_turns _ _ _ rules _ C). apply (claimed_before T L_q claim _ i1 rules); [lia | exact c1].
Qed.

(* Who takes a turn long after the other's claim has seen both at rest. *)
Lemma long_after g g' S_ L sure ended owns a last n b x :
  counts g sure ended S_ L -> takes_it S_ L owns a n -> (a <= last)%nat -> (g' (b + 1)%nat <= g (a - d)%nat)%R ->
  newer k r g last g' b (v x).
Proof.
  intros C (sa & _) le before. pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ C) as gg.
  pose proof three as m3. unfold d in *.
  destruct (S_counts _ _ _ _ _ _ _ _ _ _ _ C a) as [short stretch].
  pose proof (begins_least m T G patient graceful n).
  exists (g (a - 1)%nat), (g a).
  pose proof (sure_of _ _ _ _ _ _ _ _ _ _ _ C (a - 1)%nat (stretch (a - 1)%nat ltac:(lia) ltac:(lia)) x) as [still _].
  pose proof (sure_of _ _ _ _ _ _ _ _ _ _ _ C a (stretch a ltac:(lia) ltac:(lia)) x) as [still' _].
  split; [exact still |]. split; [exact still' |].
  pose proof (spacing k g gg (a - (G + 1 - m)) (G - m)) as [A _]. replace (a - (G + 1 - m) + (G - m))%nat with (a - 1)%nat in A by lia.
  pose proof (spacing k g gg (a - 1) 1) as [B _]. replace (a - 1 + 1)%nat with a in B by lia. simpl INR in B.
  pose proof (calls_ordered k g ok gg a last le).
  replace (S b) with (b + 1)%nat by lia.
  assert (g0 : (0 < ego_go k)%R) by (destruct ok; lra).
  assert (gone : (r / ego_go k < INR (G - m - 1) * period k)%R).
  { apply Rmult_lt_reg_r with (ego_go k); [exact g0 |]. replace (r / ego_go k * ego_go k)%R with r by (field; lra). lra. }
  replace (G - m)%nat with (S (G - m - 1)) in A by lia. rewrite S_INR in A.
  pose proof (A3_latency k ok). pose proof (jitter_nonneg k ok). unfold switching in *. split; lra.
Qed.

(* P stands in a zone that is held: both have surely rested for more than the grace, and P is so far beyond the zone's border as it
   may have crept meanwhile; up to call h, or since. *)
Definition held (z : zone) (l : log) (S_ : nat -> nat) (i : nat) := exists h, (h <= i)%nat /\ (G + 1 <= S_ h)%nat /\
  (s_in z + (INR (G + 1) * period k * (r + dip k / 2) + position_error k) < own_s (ego_at l h))%R.

(* Such a claim is newer than every one by which Q opens the zone: Q did so before P was in it, and has been seen at rest since. *)
Lemma held_is_newer p q sure ended S_ L place x z y c l (claimed' : nat -> Prop) b' i j :
  counts p sure ended S_ L -> on_grid k q -> (0 <= r)%R -> motion place (v x) -> true_log k l place (v x) p c ->
  mirrored z y -> hold (b' j) (place (q j)) (v x (q j)) ->
  held z l S_ i -> opened_at k b' y claimed' j -> newer k r p i q j (v (negb x)).
Proof.
  intros P gq r0 moves_ truth_ mir [[_ tT] _] (h & hi & rested & beyond) [_ stop].
  pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ P) as gp. pose proof three as m3.
  destruct (S_counts _ _ _ _ _ _ _ _ _ _ _ P h) as [short stretch].
  destruct (truth_ (h - 1)%nat) as ((sT & _) & _). replace (S (h - 1)) with h in sT by lia.
  assert (slow : forall n w, (h - G <= n <= h)%nat -> (v w (p n) <= r)%R).
  { intros n w hn. apply (sure_of _ _ _ _ _ _ _ _ _ _ _ P n (stretch n ltac:(lia) ltac:(lia)) w). }
  assert (begun_ : (from <= p (h - G)%nat)%R).
  { apply Rle_trans with (1 := begun _ _ _ _ _ _ _ _ _ _ _ P). apply (calls_ordered k p ok gp). lia. }
  (* P was in the zone G periods before. *)
  pose proof (creeps_throughout k (v x) from r ok (keeps x) p gp place (h - G) G moves_ begun_) as C.
  replace (h - G + G)%nat with h in C by lia.
  specialize (C ltac:(intros n hn; apply slow; lia)).
  pose proof (spacing k p gp (h - G) G) as [_ span]. replace (h - G + G)%nat with h in span by lia.
  assert (d0 : (0 <= r + dip k / 2)%R).
  { assert (0 <= dip k)%R; [| lra]. unfold dip. destruct ok.
    apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [nra | left; apply Rinv_0_lt_compat; lra]. }
  assert (way : ((p h - p (h - G)%nat) * (r + dip k / 2) <= INR (G + 1) * period k * (r + dip k / 2))%R).
  { apply Rmult_le_compat_r; [exact d0 |]. rewrite plus_INR. simpl INR.
    assert (0 < period k)%R by (destruct ok; lra). lra. }
  (* And not yet when Q could open it. *)
  assert (before : (q j < p (h - G)%nat)%R).
  { destruct (Rlt_le_dec (q j) (p (h - G)%nat)) as [? | late]; [assumption | exfalso].
    pose proof (advances place (v x) (p (h - G)%nat) (q j) moves_ late) as on_.
    destruct mir as (_ & _ & m3' & _). rewrite m3' in stop. unfold rest_of in stop. cbn in stop.
    assert (0 <= w_most (b' j) * w_most (b' j) / (precedence_braking k + precedence_braking k))%R.
    { apply Rmult_le_pos; [apply Rle_0_sqr | left; apply Rinv_0_lt_compat; destruct ok; lra]. }
    lra. }
  exists (p (h - 1)%nat), (p h). split; [apply slow; lia |]. split; [apply slow; lia |].
  pose proof (spacing k q gq j 1) as [_ next]. replace (j + 1)%nat with (S j) in next by lia. simpl INR in next.
  pose proof (spacing k p gp (h - G) (G - 1)) as [A _]. replace (h - G + (G - 1))%nat with (h - 1)%nat in A by lia.
  pose proof (spacing k p gp (h - 1) 1) as [B _]. replace (h - 1 + 1)%nat with h in B by lia. simpl INR in B.
  pose proof (calls_ordered k p ok gp h i hi).
  assert (g0 : (0 < ego_go k)%R) by (destruct ok; lra).
  assert (gone : (r / ego_go k < INR (G - m - 1) * period k)%R).
  { apply Rmult_lt_reg_r with (ego_go k); [exact g0 |]. replace (r / ego_go k * ego_go k)%R with r by (field; lra). lra. }
  pose proof (A3_latency k ok). pose proof (jitter_nonneg k ok). unfold switching in *.
  destruct en as [[-> j0] | [-> j8]].
  - replace (G - 1)%nat with (S (S (G - 2 - 1))) in A by lia. rewrite !S_INR in A. split; lra.
  - replace (G - 1)%nat with (S (S (S (G - 3 - 1)))) in A by lia. rewrite !S_INR in A. split; lra.
Qed.

(* P holds a turn, and Q claims: one of both claims is newer. *)
Lemma turn_and_claim p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p turn_q claim_q i n j :
  counts p sure_p ended_p S_p L_p -> counts q sure_q ended_q S_q L_q ->
  takes_turns S_p L_p owns_p turn_p -> takes_turns S_q L_q owns_q turn_q -> claims_by_arrival L_q claim_q ->
  agree p q L_q owns_p owns_q -> agree q p L_p owns_q owns_p ->
  turn_p i = Some n -> claim_q j \/ turn_q j <> None ->
  (forall x, newer k r p i q j (v x)) \/ (forall x, newer k r q j p i (v x)).
Proof.
  intros P Q rp rq cq order order' tp claims.
  pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ P) as gp. pose proof (grid_of _ _ _ _ _ _ _ _ _ _ _ Q) as gq.
  destruct (taken m T G patient graceful S_p L_p owns_p turn_p i n rp tp) as (i0 & lei & held_p & takes_p).
  change (takes_it S_p L_p owns_p i0 n) in takes_p.
  pose proof (calls_ordered k p ok gp (i0 - d) i0 ltac:(lia)). pose proof (next_one q j gq). pose proof (next_one p i gp).
  destruct (Rle_lt_dec (q j) (p i0)) as [before | after_].
  - left. intros x. apply (long_after p q S_p L_p sure_p ended_p owns_p i0 i n j x P takes_p lei).
    destruct (Rle_lt_dec (q (j + 1)%nat) (p (i0 - d)%nat)) as [? | near]; [assumption | exfalso].
    destruct claims as [cl | tq].
    + exact (no_arrival_since p q _ _ _ _ _ _ _ _ _ claim_q i0 n j P Q cq takes_p near cl).
    + destruct (turn_q j) as [n' |] eqn:e; [| congruence].
      exact (not_held_before p q _ _ _ _ _ _ _ _ _ _ turn_q i0 n j n' P Q rq order' takes_p e before near).
  - destruct claims as [cl | tq].
    { exfalso. refine (no_arrival_since p q _ _ _ _ _ _ _ _ _ claim_q i0 n j P Q cq takes_p _ cl). lra. }
    destruct (turn_q j) as [n' |] eqn:e; [| congruence].
    destruct (taken m T G patient graceful S_q L_q owns_q turn_q j n' rq e) as (j0 & lej & held_q & takes_q).
    change (takes_it S_q L_q owns_q j0 n') in takes_q.
    pose proof (calls_ordered k q ok gq (j0 - d) j0 ltac:(lia)).
    destruct (Rle_lt_dec (q j0) (p i0)) as [overlap | q_later].
    + exfalso. destruct (last_call m T G patient graceful q j0 j (p i0)) as (j' & hj' & now); [lia | lra |].
      refine (not_held_before p q _ _ _ _ _ _ _ _ _ _ turn_q i0 n j' n' P Q rq order' takes_p (held_q j' ltac:(lia)) _ _); lra.
    + destruct (Rle_lt_dec (p i) (q j0)) as [p_before | overlap].
      * right. intros x. apply (long_after q p S_q L_q sure_q ended_q owns_q j0 j n' i x Q takes_q lej).
        destruct (Rle_lt_dec (p (i + 1)%nat) (q (j0 - d)%nat)) as [? | close]; [assumption | exfalso].
        exact (not_held_before q p _ _ _ _ _ _ _ _ _ _ turn_p j0 n' i n Q P rp order takes_q tp p_before close).
      * exfalso. destruct (last_call m T G patient graceful p i0 i (q j0)) as (i' & hi' & now); [lia | lra |].
        refine (not_held_before q p _ _ _ _ _ _ _ _ _ _ turn_p j0 n' i' n Q P rp order takes_q (held_p i' ltac:(lia)) _ _); lra.
Qed.

Section Two.
Variables (p q : nat -> R) (sure_p ended_p sure_q ended_q : nat -> Prop) (S_p S_q : nat -> nat) (L_p L_q : nat -> option nat).
Variables (owns_p owns_q : nat -> nat -> Prop) (turn_p turn_q : nat -> option nat) (claim_p claim_q : nat -> Prop).
Hypothesis P : counts p sure_p ended_p S_p L_p.
Hypothesis Q : counts q sure_q ended_q S_q L_q.
Hypothesis rules_p : takes_turns S_p L_p owns_p turn_p.
Hypothesis rules_q : takes_turns S_q L_q owns_q turn_q.
Hypothesis arrivals_p : claims_by_arrival L_p claim_p.
Hypothesis arrivals_q : claims_by_arrival L_q claim_q.
Hypothesis order : agree p q L_q owns_p owns_q.
Hypothesis order' : agree q p L_p owns_q owns_p.
Hypothesis by_arrival : forall i j, claim_p i -> ~ claim_q j.

(* Of each two claims of two shields one is newer: the premise of Theorem 4. *)
Theorem one_claim_is_newer i j : claim_p i \/ turn_p i <> None -> claim_q j \/ turn_q j <> None ->
  (forall x, newer k r p i q j (v x)) \/ (forall x, newer k r q j p i (v x)).
Proof.
  intros [a | a] b.
  - destruct b as [b | b]; [destruct (by_arrival i j a b) |].
    destruct (turn_q j) as [n' |] eqn:e; [| congruence]. apply or_comm.
    apply (turn_and_claim q p sure_q ended_q sure_p ended_p S_q S_p L_q L_p owns_q owns_p turn_q turn_p claim_p j n' i); auto.
  - destruct (turn_p i) as [n |] eqn:e; [| congruence].
    apply (turn_and_claim p q sure_p ended_p sure_q ended_q S_p S_q L_p L_q owns_p owns_q turn_p turn_q claim_q i n j); auto.
Qed.

(* Theorem 4 from what the shields count: P is the shield of vehicle x. *)
Section Vehicles.
Variables (place : bool -> R -> R) (x : bool) (z y : zone) (c c' : nat -> R) (l l' : log) (b b' : nat -> bounds) (since since' : nat).
Hypothesis P6 : (precedence_braking k <= ego_braking k)%R.
Hypothesis rest : (0 <= r < unheld k)%R.
Hypothesis mir : mirrored z y.
Hypothesis moves : forall w, motion (place w) (v w).
Let claimed i := claim_p i \/ turn_p i <> None.
Let claimed' j := claim_q j \/ turn_q j <> None.
(* At a crossing, one may also hold a zone. *)
Let claimed_or_held i := claimed i \/ held z l S_p i.
Let claimed_or_held' j := claimed' j \/ held y l' S_q j.

Lemma newer_order i j : claimed i -> claimed' j -> newer k r p i q j (v (negb x)) \/ newer k r q j p i (v x).
Proof. intros ci cj. destruct (one_claim_is_newer i j ci cj) as [n | n]; [left | right]; apply n. Qed.

Theorem precedence_is_safe_by_counts : lane z = false -> lane y = false ->
  watches k (judged k l c b z claimed_or_held since) (place x) (v x) (place (negb x)) (v (negb x)) p c l b since ->
  watches k (judged k l' c' b' y claimed_or_held' since') (place (negb x)) (v (negb x)) (place x) (v x) q c' l' b' since' ->
  forall u, (Rmax (p since) (q since') <= u)%R -> ~ inside z (place x u) (place (negb x) u).
Proof.
  intros lz ly W W'.
  apply (precedence_is_safe_at_crossings k r z y (place x) (v x) (place (negb x)) (v (negb x)) claimed_or_held p c l b since
           claimed_or_held' q c' l' b' since' ok P6 rest lz ly mir (moves x) (moves (negb x)) W W').
  pose proof W as [gp _ true_ keeps_ view _ _]. pose proof W' as [gq _ true_' keeps_' view' _ _].
  intros i j hi open hj open'.
  destruct (known_holds k _ _ _ _ _ ok (moves (negb x)) keeps_ (view i hi)) as [_ B].
  destruct (known_holds k _ _ _ _ _ ok (moves x) keeps_' (view' j hj)) as [_ B'].
  pose proof open as [[cl | h] _]; [pose proof open' as [[cl' | h'] _]; [exact (newer_order i j cl cl') |] |].
  - right. pose proof (held_is_newer q p _ _ _ _ (place (negb x)) (negb x) y z c' l' claimed_or_held b j i Q gp (proj1 rest)
      (moves (negb x)) true_' (mirrored_back z y mir) B h' open) as N. rewrite Bool.negb_involutive in N. exact N.
  - left. exact (held_is_newer p q _ _ _ _ (place x) x z y c l claimed_or_held' b' i j P gq (proj1 rest)
      (moves x) true_ mir B' h open').
Qed.

Theorem precedence_is_safe_in_lanes_by_counts mine theirs : lane z = true -> lane y = true ->
  creeps_behind k r -> (lead_from z < s_in z - t_in z < lead_to z)%R ->
  watches k (judged_in_lane k l c b z claimed since mine theirs) (place x) (v x) (place (negb x)) (v (negb x)) p c l b since ->
  watches k (judged_in_lane k l' c' b' y claimed' since' theirs mine) (place (negb x)) (v (negb x)) (place x) (v x) q c' l' b' since' ->
  (place x (Rmax (p since) (q since')) < s_in z)%R -> (place (negb x) (Rmax (p since) (q since')) < t_in z)%R ->
  forall u, (Rmax (p since) (q since') <= u)%R -> ~ inside z (place x u) (place (negb x) u).
Proof.
  intros lz ly P7 corner W W'.
  exact (precedence_is_safe_in_lanes k r z y (place x) (v x) (place (negb x)) (v (negb x)) mine theirs claimed p c l b since claimed' q
           c' l' b' since' ok P6 rest P7 lz ly mir corner (moves x) (moves (negb x)) W W' newer_order).
Qed.
End Vehicles.
End Two.
End Newer.
